// Section 11, links: rest, length, momentum, rotation, pendulum, chain, springs.
#include <cmath>
#include <numbers>

#include "core/model/angle.hpp"
#include "core/model/text.hpp"
#include "core/reference/closed_forms.hpp"
#include "core/reference/elastica.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/truths/conformance/conformance.hpp"

namespace taut {

namespace {

using conformance::first_passage;
using conformance::for_each_solver;
using conformance::kFine;
using conformance::own_stiffness;

/// A free sheet whose links are all a fiftieth too long.
Scene stretched() {
  Scene s = bare::sheet(6, 5, {.shear = true});
  for (Vec3& x : s.start.x) x *= 1.02;
  return s;
}

/// Two masses, 1 : 3, on a link of 1 m, `length` apart. Here and below they are those of cloth:
/// solvers that have springs for rigid links, or a penalty, are made for them.
Scene rod(double length) {
  Scene s = bare::pair(length, 1, 0.01, 0.03);
  s.dt = kFine;
  return s;
}

/// A chain of springs of 0.25 m in turn of each family, that hangs from its first vertex.
Scene springs() {
  Scene s = bare::chain(4, 1, 0.05);
  s.stiffness = {200, 100, 50};
  for (std::size_t j = 0; j < s.links.size(); ++j) s.links[j].family = static_cast<Family>(j % 3);
  std::ranges::stable_sort(s.links, {}, [](const Link& l) { return static_cast<int>(l.family); });
  s.dt = kFine;
  return s;
}

/// A level strip of two columns along -y, clamped midway between its first rows, 1 m beyond that.
Scene clamped_strip(int segments, double gamma) {
  const double l = 1 / (segments - 0.5), density = 0.1;
  Scene s = bare::sheet(2, segments + 1, {.structural = true, .shear = true}, Lumping::area, l,
                        segments * l, density * segments * l * l);
  s.pins = {0, 1, 2, 3};
  s.gravity = {0, 0, -kG};
  const double stiffness = density * kG / gamma;
  s.bending = Bending{stiffness, stiffness};
  s.damping = 4;
  s.dt = 1.0 / 128;
  return s;
}

}  // namespace

TAUT_TRUTH(any_rest, 11, 8, "a sheet at rest that nothing moves rests", "Newton's first law",
           "rest", "links") {
  for_each_solver(findings, [&](const std::string& solver) {
    const Scene s = bare::sheet(6, 5, {.shear = true});
    if (!can_run(findings, solver, s)) return;
    const Simulation sim(s, solver, 64);
    findings.below(solver, "way of a sheet at rest that nothing moves, in 1 s", "m",
                   max_distance(sim.state().x, s.start.x), 1e-5);
  });
}

TAUT_TRUTH(any_link, 11, 9, "a link that starts too long or too short gets its rest length",
           "definition of a link; springs swing about it", "rigid link", "links") {
  for_each_solver(findings, [&](const std::string& solver) {
    for (const double length : {1.02, 0.98}) {
      const Scene s = rod(length);
      if (!can_run(findings, solver, s)) return;
      Simulation sim(s, solver);
      double sum = 0;
      for (const double now : sim.record(512, [&] { return (sim.x(1) - sim.x(0)).norm(); }))
        sum += now / 512;
      findings.equal(
          solver,
          length > 1 ? "mean length over 2 s, from 1.02 m" : "mean length over 2 s, from 0.98 m",
          "m", sum, 1, 2e-3);
    }
  });
}

TAUT_TRUTH(any_momentum, 11, 10, "links move no centre of mass, whatever the masses",
           "Newton's third law", "momentum", "links") {
  for_each_solver(findings, [&](const std::string& solver) {
    const Scene pair = rod(1.02);
    if (!can_run(findings, solver, pair)) return;
    const Simulation two(pair, solver, 256);
    findings.below(
        solver, "way of the centre of masses 1 : 3 on a strained link, in 1 s", "m",
        (mean(pair.mesh.mass, two.state().x) - mean(pair.mesh.mass, pair.start.x)).norm(), 1e-4);
    Scene s = stretched();
    s.gravity = Vec3(0, -kG, 0);
    const Vec3 throws(1, 2, -0.5);
    for (Vec3& v : s.start.v) v = throws;
    if (!can_run(findings, solver, s)) return;
    const Simulation sim(s, solver, 64);
    const Vec3 way = mean(s.mesh.mass, sim.state().x) - mean(s.mesh.mass, s.start.x) - throws;
    // g t^2/2 (1 + c/n), where the integrator decides -1 <= c <= 1
    findings.equal(solver, "fall of the centre of mass of a strained sheet over g t^2/2 at 1 s",
                   "1", -way.y() / (kG / 2), 1, 1.05 / 64);
    findings.below(solver, "its way across gravity, beyond v0 t", "m", std::hypot(way.x(), way.z()),
                   1e-4);
  });
}

TAUT_TRUTH(any_rotation, 11, 11, "a free rod turns by omega t about its centre of mass",
           "conservation of angular momentum", "rotation", "links") {
  for_each_solver(findings, [&](const std::string& solver) {
    Scene s = rod(1);
    const double spin = 2;
    const Vec3 axis = Vec3(1, -2, 0).normalized(),  // perpendicular to the link
        center = mean(s.mesh.mass, s.start.x);
    for (std::size_t i = 0; i < 2; ++i) s.start.v[i] = spin * axis.cross(s.start.x[i] - center);
    if (!can_run(findings, solver, s)) return;
    const Simulation sim(s, solver, 256);
    const Vec3 before = s.start.x[1] - s.start.x[0], now = sim.x(1) - sim.x(0);
    findings.equal(solver, "angle turned in 1 s at 2 rad/s", "rad",
                   std::atan2(axis.dot(before.cross(now)), before.dot(now)), spin, 0.02 * spin);
  });
}

TAUT_TRUTH(any_pendulum, 11, 12, "quarter of a pendulum's period, pi/2 sqrt(L/g)/AGM(1, cos(a/2))",
           "Gauss", "pendulum", "links, gravity") {
  for_each_solver(findings, [&](const std::string& solver) {
    const double amplitude = 60 * kDegree;
    Scene s =
        under_gravity(bare::chain(1, 1, 0.02, {std::sin(amplitude), -std::cos(amplitude), 0}));
    s.dt = kFine;
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver);
    const double expected = reference::pendulum_quarter(1, kG, amplitude);
    findings.equal(solver, "time from 60 degrees to the lowest point", "s",
                   first_passage(sim, 2, [&] { return sim.x(1).x(); }), expected, 0.01 * expected);
  });
}

TAUT_TRUTH(any_chain, 11, 13,
           "a chain hangs straight at its length; between two supports it is the discrete catenary",
           "statics of rods", "hanging chain", "links, gravity") {
  for_each_solver(findings, [&](const std::string& solver) {
    Scene s = under_gravity(bare::chain(16, 1, 0.01));
    s.dt = kFine;
    if (!can_run(findings, solver, s)) return;
    const double stretch = 0.01 * kG * 16 * 17 / 2 / own_stiffness(solver, s);
    if (stretch > 0.01) {
      findings.not_applicable(solver, "its links are springs of its own, which the chain makes " +
                                          general(100 * stretch, 3) + " % longer");
      return;
    }
    Simulation sim(s, solver);
    double sum = 0;
    for (const double depth : sim.record(256, [&] { return -sim.x(16).y(); })) sum += depth / 256;
    findings.equal(solver, "mean depth over 1 s of the end of a chain of 16 rods", "m", sum, 1,
                   0.01);
    const reference::Catenary catenary = reference::discrete_catenary(16, 0.8, 1.0 / 16, 0.01 * kG);
    for (std::size_t i = 0; i < s.start.x.size(); ++i)
      s.start.x[i] = Vec3(catenary.x[i], catenary.y[i], 0);
    s.pins = {0, 16};
    if (!can_run(findings, solver, s)) return;
    Simulation hung(s, solver);
    const double most = hung.worst(
        128, [&](int) { return max_distance(hung.state().x, s.start.x) / catenary.sag(); });
    findings.below(solver, "way in 0.5 s of a chain that starts as the catenary, over its sag", "1",
                   most, 0.02);
  });
}

TAUT_TRUTH(any_wave, 11, 14,
           "a hanging chain swings in its slowest mode with w^2 = (g/l) xi, L_n(xi) = 0",
           "D. Bernoulli 1733", "wave", "links, gravity") {
  for_each_solver(findings, [&](const std::string& solver) {
    const int n = 8;
    const double amplitude = 0.03, l = 1.0 / n;
    Scene s = under_gravity(bare::chain(n, 1, 0.01));
    s.dt = kFine;
    const std::vector<double> mode = reference::hanging_chain_mode(n, 1);
    double before = 0, y = 0;
    for (int i = 1; i <= n; ++i) {
      const double x = amplitude * mode[to_index(i - 1)];
      y -= std::sqrt(l * l - (x - before) * (x - before));
      s.start.x[to_index(i)] = Vec3(x, y, 0);
      before = x;
    }
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver);
    const double expected =
        std::numbers::pi / 2 / reference::hanging_chain_frequencies(n, 1, kG).front();
    findings.equal(solver, "quarter of the period of the slowest mode of 8 rods", "s",
                   first_passage(sim, 2, [&] { return sim.x(n).x(); }), expected, 0.02 * expected);
  });
}

TAUT_TRUTH(any_sag, 11, 15, "a chain of springs at rest: each is longer by its load over K",
           "Hooke, statics", "static sag", "springs, gravity") {
  for_each_solver(findings, [&](const std::string& solver) {
    Scene s = under_gravity(springs());
    double y = 0, sag = 0;
    for (int j = 0; j < 4; ++j) {
      const double longer = (4 - j) * 0.05 * kG / s.stiffness[to_index(j % 3)];
      sag += longer;
      y -= 0.25 + longer;
      s.start.x[to_index(j + 1)].y() = y;
    }
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver);
    const double most =
        sim.worst(256, [&](int) { return max_distance(sim.state().x, s.start.x) / sag; });
    findings.below(solver, "way in 1 s of a chain of springs that starts at rest, over its sag",
                   "1", most, 0.03);
  });
}

TAUT_TRUTH(any_spring, 11, 16,
           "masses on equal springs swing with w = 2 sqrt(K/m) sin(pi/(2(2n + 1)))",
           "normal modes of a chain fixed at one end", "spring period", "springs") {
  for_each_solver(findings, [&](const std::string& solver) {
    const int n = 4;
    const double stiffness = 100, mass = 0.05, amplitude = 0.02;
    Scene s = bare::chain(n, 1, mass);
    s.stiffness = {stiffness, stiffness, stiffness};
    s.dt = kFine;
    for (int i = 1; i <= n; ++i)
      s.start.x[to_index(i)].y() -= amplitude * std::sin(i * std::numbers::pi / (2 * n + 1));
    if (!can_run(findings, solver, s)) return;
    Simulation sim(s, solver);
    const double expected =
        std::numbers::pi / 2 / reference::spring_chain_frequencies(n, stiffness, mass).front();
    findings.equal(solver, "quarter of the period of the slowest mode of 4 springs", "s",
                   first_passage(sim, 2, [&] { return -1 - sim.x(n).y(); }), expected,
                   0.03 * expected);
  });
}

TAUT_TRUTH(any_bending, 11, 30,
           "a strip clamped level hangs as B theta'' = -w (L - s) cos(theta): H/W of its end",
           "heavy elastica", "elastica", "bending, links, gravity, damping") {
  for_each_solver(findings, [&](const std::string& solver) {
    const double gamma = 5;
    const int segments = 6;
    const Scene s = clamped_strip(segments, gamma);
    if (!can_run(findings, solver, s)) return;
    const Simulation sim(s, solver, 640);
    const auto row = [&](int j) { return Vec3((sim.x(2 * j) + sim.x(2 * j + 1)) / 2); };
    const Vec3 out = row(segments) - (row(0) + row(1)) / 2;
    const reference::Elastica exact = reference::elastica(gamma);
    const double expected = exact.drop / exact.reach;
    findings.equal(solver, "drop over reach of the end of 6 segments, w L^3/B = 5", "1",
                   out.z() / out.y(), expected, 0.05 * expected);
  });
}

}  // namespace taut
