// Section 11, vertices without links: time, inertia, gravity, damping, pins, wind.
#include <cmath>

#include "experiments/truths/conformance/conformance.hpp"

namespace taut {

namespace {

using conformance::for_each_solver;
using conformance::kFine;
using conformance::square;

/// The square, each vertex with a velocity of its own of some 3 m/s.
Scene thrown() {
  Scene s = square();
  for (std::size_t i = 0; i < s.start.v.size(); ++i) {
    const double k = static_cast<double>(i);
    s.start.v[i] = Vec3(1.1 + 0.3 * k, 2.3 - 0.2 * k, -1.7 + 0.1 * k);
  }
  return s;
}

/// Largest distance of a vertex from x0 + ahead v0.
double off(const Scene& s, const State& state, double ahead) {
  std::vector<Vec3> expected = s.start.x;
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] += ahead * s.start.v[i];
  return max_distance(state.x, expected);
}

constexpr double kFloat = 2e-4;  ///< m, rounding of float32 in places of a few metres

}  // namespace

TAUT_TRUTH(any_time_step, 11, 1, "a second is a second, in 64 steps and in 128",
           "the step is an argument of the solver", "time step", "") {
  for_each_solver(findings, [&](const std::string& solver) {
    Scene coarse = thrown(), fine = thrown();
    fine.dt /= 2;
    if (!can_run(findings, solver, coarse)) return;
    const Simulation a(coarse, solver, 64), b(fine, solver, 128);
    findings.below(solver, "distance of places after 1 s, by steps of 1/64 s and of 1/128 s", "m",
                   max_distance(a.state().x, b.state().x), kFloat);
  });
}

TAUT_TRUTH(any_inertia, 11, 2, "without forces x = x0 + v0 t and v = v0", "Newton's first law",
           "inertia", "") {
  for_each_solver(findings, [&](const std::string& solver) {
    const Scene s = thrown();
    if (!can_run(findings, solver, s)) return;
    const Simulation sim(s, solver, 64);
    findings.below(solver, "distance from x0 + v0 t after 1 s", "m", off(s, sim.state(), 1),
                   kFloat);
    findings.below(solver, "distance of the velocity from v0", "m/s",
                   max_distance(sim.state().v, s.start.v), 0.02);
  });
}

TAUT_TRUTH(any_fall, 11, 3,
           "x0 + v0 t + g t^2/2 (1 + c/n), |c| <= 1, whatever the mass; and x(1 s) - 2 x(1/2 s) + "
           "x0 = g/4 s^2",
           "Galilei; sums of the integrators' recurrences", "free fall", "gravity") {
  for_each_solver(findings, [&](const std::string& solver) {
    Scene s = thrown();
    s.gravity = Vec3(2.25, -3, 9);  // |g| = 9.75 m/s^2, parallel to no axis
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver, 32);
    const std::vector<Vec3> half = sim.state().x;
    sim.step(32);
    double curved = 0, place = 0;
    for (int i = 0; i < 4; ++i) {
      const Vec3& x0 = s.start.x[to_index(i)];
      const Vec3 second = sim.x(i) - 2 * half[to_index(i)] + x0;
      curved = larger(curved, (4 * second - s.gravity).norm() / s.gravity.norm());
      place = larger(place, (sim.x(i) - x0 - s.start.v[to_index(i)] - s.gravity / 2).norm());
    }
    findings.below(solver, "distance of the acceleration from g, over |g|", "1", curved, 5e-4);
    findings.below(solver, "distance from x0 + v0 t + g t^2/2 after 1 s", "m", place,
                   1.05 / 64 * s.gravity.norm() / 2);
  });
}

TAUT_TRUTH(any_damping, 11, 4, "a damped velocity is v0 exp(-c t), whatever the mass",
           "definition of the scene's damping", "damping", "damping") {
  for_each_solver(findings, [&](const std::string& solver) {
    Scene s = thrown();
    s.damping = 2;
    if (!can_run(findings, solver, s)) return;
    const Simulation sim(s, solver, 64);
    double least = 1e300, most = 0;
    for (int i = 0; i < 4; ++i) {
      const double left = sim.v(i).norm() / s.start.v[to_index(i)].norm();
      least = std::min(least, left);
      most = larger(most, left);
    }
    const double left = std::exp(-2.0);
    findings.equal(solver, "least share of a velocity left after 1 s at 2/s", "1", least, left,
                   0.04 * left);
    findings.equal(solver, "largest such share", "1", most, left, 0.04 * left);
  });
}

TAUT_TRUTH(any_pins, 11, 5, "pinned vertices stay", "definition of a pin", "pins", "") {
  for_each_solver(findings, [&](const std::string& solver) {
    Scene s = under_gravity(square());
    s.pins = {0, 3};
    if (!can_run(findings, solver, s)) return;
    const Simulation sim(s, solver, 64);
    double way = 0;
    for (const int pin : s.pins) way = larger(way, (sim.x(pin) - s.start.x[to_index(pin)]).norm());
    findings.below(solver, "way of two pinned vertices in 1 s", "m", way, 1e-6);
  });
}

TAUT_TRUTH(any_moving_pins, 11, 6, "moving pins are where the scene has them",
           "definition of a motion", "moving pins", "moving pins") {
  for_each_solver(findings, [&](const std::string& solver) {
    Scene s = square();
    s.pins = {0, 1, 3};
    s.pin_motions = {{{0}, {.velocity = {0.1, 0, 0.2}}},
                     {{1}, {.spin = {0, 1, 0.5}, .pivot = {0.5, 0, 0}}},
                     {{3}, {.path = {{0.25, {0, 0, 0}}, {0.75, {0.1, 0.2, -0.3}}}}}};
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver);
    const double most = sim.worst(64, [&](int n) {
      double one = 0;
      for (const int pin : s.pins)
        one = larger(one, (sim.x(pin) - pin_position(s, pin, n * s.dt)).norm());
      return one;
    });
    findings.below(solver, "distance of three moving pins from their places, within 1 s", "m", most,
                   1e-6);
  });
}

TAUT_TRUTH(any_release, 11, 7,
           "a moved pin that lets go flies on: x + v t + g t^2/2 (1 + c/n), |c| <= 1",
           "Newton's first law from the state at the release", "release", "moving pins") {
  for_each_solver(findings, [&](const std::string& solver) {
    constexpr int kHeld = 16, kFree = 48;  // steps
    Scene s = under_gravity(square());
    const Vec3 velocity(3, 4, -1);
    s.pins = {0, 3};
    s.pin_motions = {{{0, 3}, {.velocity = velocity}}};
    for (const std::size_t i : {0u, 3u}) s.start.v[i] = velocity;
    s.steps = kHeld + kFree;
    s.releases = {{kHeld, {0, 3}}};
    if (!can_run(findings, solver, s)) return;
    const Simulation sim(s, solver, s.steps);
    const double t = kFree * s.dt;
    const Vec3 expected = s.start.x[0] + s.steps * s.dt * velocity + t * t / 2 * s.gravity;
    findings.below(solver, "distance from the parabola 0.75 s after the release", "m",
                   (sim.x(0) - expected).norm(), 1.05 / kFree * kG * t * t / 2);
  });
}

TAUT_TRUTH(any_wind, 11, 17,
           "a face that wind meets squarely: v = W (1 - exp(-c A t/m)), c A W/3 at each corner",
           "the scene's law of wind, in continuous time", "wind", "wind") {
  for_each_solver(findings, [&](const std::string& solver) {
    const double c = 0.8, area = 0.25, mass = 0.1, speed = 5;
    Scene s = bare::scene({Vec3::Zero(), Vec3(1, 0, 0), Vec3(0, 0, -0.5)}, {mass, mass, mass}, {});
    s.mesh.triangles = {{0, 1, 2}};
    s.dt = kFine;
    s.steps = 128;
    s.wind = Wind{Vec3(1, speed, 2), c, Wind::Law::relative};
    if (!can_run(findings, solver, s)) return;
    const Simulation sim(s, solver, 128);
    const double expected = speed * (1 - std::exp(-c * area * 0.5 / (3 * mass)));
    double worst = 0;
    for (int i = 0; i < 3; ++i) worst = larger(worst, (sim.v(i) - Vec3(0, expected, 0)).norm());
    findings.equal(solver, "speed along the normal after 0.5 s", "m/s", sim.v(0).y(), expected,
                   0.02 * expected);
    findings.below(solver, "distance of a corner's velocity from that", "m/s", worst,
                   0.02 * expected);
  });
}

}  // namespace taut
