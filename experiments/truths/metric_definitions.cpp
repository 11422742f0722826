// Section 10: metrics of states whose values are known by construction.
#include <cmath>
#include <numbers>

#include "core/model/index.hpp"
#include "core/reference/closed_forms.hpp"
#include "core/reference/dense.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/metrics/reference_path.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

/// A metric's value for a run through these states; NaN if it has none for this scene.
double measured(std::string_view value, Scene scene, const std::vector<State>& states) {
  scene.steps = static_cast<int>(states.size()) - 1;
  const auto [entry, spec] = find_value(value);
  const auto metric = entry->make(scene);
  if (!metric) return std::nan("");
  for (int n = 0; n <= scene.steps; ++n) metric->observe({n, n * scene.dt, states[to_index(n)]});
  return metric->finish()[static_cast<std::size_t>(spec - entry->values.data())];
}

Scene sheet() { return under_gravity(bare::sheet(5, 5, {.shear = true, .bend = true})); }

State still(std::vector<Vec3> x) {
  const std::size_t n = x.size();
  return {std::move(x), std::vector<Vec3>(n, Vec3::Zero())};
}

}  // namespace

TAUT_TRUTH(metric_stretch, 10, 1, "strain is (d - r)/r per link; area strain A/A0 - 1",
           "a uniformly scaled sheet") {
  const Scene s = sheet();
  std::vector<Vec3> wide = s.mesh.rest, narrow = s.mesh.rest;
  for (Vec3& x : wide) x *= 1.1;
  for (Vec3& x : narrow) x *= 0.8;
  for (const char* name : {"stretch.rms", "stretch.max", "stretch.p95", "stretch.peak",
                           "stretch.rms.peak", "structural.rms", "shear.max", "bend.rms"})
    findings.equal("metric:stretch", std::string(name) + " of a sheet 10 % too large", "1",
                   measured(name, s, {still(wide), still(wide)}), 0.1, 1e-14);
  findings.equal("metric:stretch", "compression.max of a sheet 20 % too small", "1",
                 measured("compression.max", s, {still(narrow), still(narrow)}), 0.2, 1e-14);
  findings.equal("metric:area", "area.rms of a sheet 10 % too large", "1",
                 measured("area.rms", s, {still(wide), still(wide)}), 0.21, 1e-13);
}

TAUT_TRUTH(metric_energy, 10, 2, "free fall conserves (KE + PE)/(m g L)", "the exact parabola") {
  Scene s = sheet();
  s.steps = 128;
  std::vector<State> falling;
  for (int n = 0; n <= s.steps; ++n) {
    const double t = n * s.dt;
    State state = s.start;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      state.x[i] += s.gravity * t * t / 2;
      state.v[i] = s.gravity * t;
    }
    falling.push_back(state);
  }
  findings.below("metric:energy", "energy of a body in free fall, per m g L", "1",
                 std::abs(measured("energy.mean", s, falling)), 1e-13);
  // mean of (g t)^2/2 over the last second, in m g L with L = sqrt(2)
  double kinetic = 0;
  int count = 0;
  for (int n = 65; n <= 128; ++n, ++count) kinetic += std::pow(kG * n * s.dt, 2) / 2;
  findings.equal("metric:energy", "its kinetic part over the last second", "1",
                 measured("energy.kinetic", s, falling), kinetic / count / (kG * std::sqrt(2.0)),
                 1e-9);
}

TAUT_TRUTH(metric_motion, 10, 3, "jitter, popping, drift and settling of prescribed motions",
           "their definitions") {
  const Scene s = sheet();
  State steady = s.start;
  for (Vec3& v : steady.v) v = Vec3(0.3, 0, 0.4);
  findings.equal("metric:jitter", "jitter.rms of a sheet at 0.5 m/s", "m/s",
                 measured("jitter.rms", s, {steady, steady, steady}), 0.5, 1e-14);
  std::vector<State> jump(4, s.start);
  for (Vec3& x : jump[2].x) x.z() += 0.01;  // out and back within a step
  findings.equal("metric:popping", "popping.peak of a jump by 1 cm and back", "m/s^2",
                 measured("popping.peak", s, jump), 0.02 / s.dt / s.dt - kG, 1e-9);
  std::vector<State> moved(2, s.start);
  for (Vec3& x : moved[1].x) x += Vec3(3, 0, 4);
  findings.equal("metric:drift", "drift.max of a sheet moved by 5 m", "m",
                 measured("drift.max", s, moved), 5, 1e-13);
  std::vector<State> slows(65, s.start);
  for (std::size_t n = 0; n < 32; ++n)
    for (Vec3& v : slows[n].v) v.x() = 1;
  findings.equal("metric:settle", "settle.time of a sheet that stops after step 31", "s",
                 measured("settle.time", s, slows), 31 * s.dt, 1e-14);
  std::vector<State> creeps(129, s.start);
  for (std::size_t n = 0; n < creeps.size(); ++n)
    for (Vec3& x : creeps[n].x) x.x() += 0.0019 * static_cast<double>(n) * s.dt;
  findings.equal("metric:settle", "of one that creeps at 1.9 mm/s, 0.5 mm further after 17 steps",
                 "s", measured("settle.time", s, creeps), 7 * 17 * s.dt, 1e-14);
}

TAUT_TRUTH(metric_penetration, 10, 4, "penetration is max(0, -signed distance)",
           "a vertex placed 3 cm deep") {
  Scene s = under_gravity(bare::scene({Vec3(0, 0.47, 0), Vec3(0, 2, 0)}, {1, 1}, {}));
  const auto depth = [&](const Shape& shape) {
    Scene with_shape = s;
    with_shape.colliders.push_back({shape, {}, 0});
    return measured("penetration.max", with_shape, {s.start, s.start});
  };
  findings.equal("metric:penetration", "depth of a vertex 3 cm inside a ball", "m",
                 depth(Ball{Vec3::Zero(), 0.5}), 0.03, 1e-14);
  findings.equal("metric:penetration", "3 cm below a plane", "m", depth(Plane{Vec3::UnitY(), 0.5}),
                 0.03, 1e-14);
  findings.equal("metric:penetration", "3 cm inside a box", "m",
                 depth(Box{Vec3::Zero(), Vec3(1, 0.5, 1)}), 0.03, 1e-14);
  findings.equal("metric:penetration", "3 cm inside a capsule", "m",
                 depth(Capsule{Vec3(-1, 0, 0), Vec3(1, 0, 0), 0.5}), 0.03, 1e-14);
  findings.below("metric:penetration", "none outside", "m", depth(Ball{Vec3(0, -1, 0), 0.5}), 0);
}

TAUT_TRUTH(metric_faces, 10, 5,
           "a face with its corners on a ball is l^2/(4R) deep, all of it geometry",
           "the circumscribed circle of a right triangle") {
  // A right triangle with legs l and its corners on a ball of radius R.
  const double radius = 0.5, l = 0.05, half = l / std::sqrt(2.0);
  const double height = std::sqrt(radius * radius - half * half);
  Scene s = under_gravity(bare::scene(
      {Vec3(half, height, 0), Vec3(-half, height, 0), Vec3(0, height, half)}, {1, 1, 1}, {}));
  s.mesh.triangles = {{0, 1, 2}};
  s.colliders.push_back({Ball{Vec3::Zero(), radius}, {}, 0});
  const std::vector<State> resting{s.start, s.start};
  findings.equal("metric:faces", "face.max of a face with its corners on a ball", "m",
                 measured("face.max", s, resting), 1.2516e-3, 5e-8);
  findings.equal("metric:faces", "face.geometry of the same face", "m",
                 measured("face.geometry", s, resting), radius - height, 1e-12);
  findings.below("metric:faces", "face.excess of the same face", "m",
                 std::abs(measured("face.excess", s, resting)), 1e-12);
  // On a capsule with its axis along x: corners l apart across it, the third l along it.
  const double across = std::sqrt(radius * radius - l * l / 4);
  s.start.x = {Vec3(0, across, l / 2), Vec3(0, across, -l / 2), Vec3(l, across, l / 2)};
  s.mesh.rest = s.start.x;
  s.colliders = {{Capsule{Vec3(-1, 0, 0), Vec3(1, 0, 0), radius}, {}, 0}};
  findings.equal("metric:faces", "face.max on a capsule, R - sqrt(R^2 - l^2/4)", "m",
                 measured("face.max", s, {s.start, s.start}), radius - across, 1e-12);
}

TAUT_TRUTH(metric_tunnelling, 10, 6,
           "vertices that end on the other side are counted, even within one step",
           "a vertex through a ball's centre") {
  Scene s = under_gravity(bare::scene({Vec3(0, 1, 0), Vec3(3, 1, 0)}, {1, 1}, {}));
  s.colliders.push_back({Ball{Vec3::Zero(), 0.3}, {}, 0});
  std::vector<State> states(2, s.start);
  for (Vec3& x : states[1].x) x.y() = -1;  // one vertex through the middle, one past the ball
  findings.equal("metric:tunnelling", "tunnelling.count of one vertex through and one past", "1",
                 measured("tunnelling.count", s, states), 1, 0);
  s.colliders = {{Capsule{Vec3(-1, 0, 0), Vec3(1, 0, 0), 0.3}, {}, 0}};
  findings.equal("metric:tunnelling", "the same of a capsule", "1",
                 measured("tunnelling.count", s, states), 1, 0);
  s.colliders = {{Capsule{Vec3(0, -0.4, 0), Vec3(0, 0.4, 0), 0.3}, {}, 0}};
  findings.equal("metric:tunnelling", "the same along its axis", "1",
                 measured("tunnelling.count", s, states), 1, 0);
}

TAUT_TRUTH(metric_crossings, 10, 7, "crossing faces that share no vertex are counted",
           "two triangles") {
  Scene s = bare::scene({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.2, 0.2, -1),
                         Vec3(0.2, 0.2, 1), Vec3(-1, -1, 3)},
                        std::vector<double>(6, 1.0), {});
  s.mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  s.self_collision = SelfCollision{0.01};
  State apart = s.start;
  for (const std::size_t i : {3u, 4u, 5u}) apart.x[i].z() += 10;
  findings.equal("metric:self_intersection", "self.crossings of two crossing faces", "1",
                 measured("self.crossings", s, {s.start, s.start}), 1, 0);
  findings.equal("metric:self_intersection", "of two faces apart", "1",
                 measured("self.crossings", s, {apart, apart}), 0, 0);
}

TAUT_TRUTH(metric_contour, 10, 8, "the line along which two faces cross has its length",
           "two triangles at right angles") {
  Scene s = bare::scene({Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(0, 3, 0), Vec3(1, 0.5, -1),
                         Vec3(1, 0.5, 1), Vec3(1, 5, 1)},
                        std::vector<double>(6, 1.0), {});
  s.mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  s.self_collision = SelfCollision{0.01};
  findings.equal("metric:self_intersection", "self.contour from y = 0.5 m to the hem at 2 m", "m",
                 measured("self.contour", s, {s.start, s.start}), 1.5, 1e-14);
}

TAUT_TRUTH(metric_momentum, 10, 9,
           "a rigid body in free flight keeps momentum and angular momentum",
           "Newton; the exact path of a spinning sheet") {
  Scene s = sheet();
  const double spin = 3;
  const Vec3 center(0.5, -0.5, 0), axis = Vec3::UnitZ();
  const auto path = [&](double pull, double spin_left) {
    std::vector<State> states;
    for (int n = 0; n <= 64; ++n) {
      const double t = n * s.dt;
      State state = s.start;
      for (std::size_t i = 0; i < state.x.size(); ++i) {
        const Vec3 arm = Eigen::AngleAxisd(spin * t, axis) * (s.mesh.rest[i] - center);
        state.x[i] = center + arm + pull * s.gravity * t * t / 2;
        state.v[i] = pull * s.gravity * t + (n > 0 ? spin_left : 1) * spin * axis.cross(arm);
      }
      states.push_back(state);
    }
    return states;
  };
  const auto check = [&](const char* name, double pull, double spin_left, const char* what,
                         const char* unit, double expected) {
    findings.equal("metric:momentum", std::string(name) + what, unit,
                   measured(name, s, path(pull, spin_left)), expected, 1e-12);
  };
  check("momentum.linear", 1, 1, " of the exact path", "m/s", 0);
  check("momentum.angular", 1, 1, " of the exact path", "1", 0);
  check("momentum.linear", 0.9, 1, " with a tenth of gravity missing, after 1 s", "m/s", 0.1 * kG);
  check("momentum.angular", 1, 0.8, " with a fifth of the spin missing", "1", 0.2);
}

TAUT_TRUTH(metric_energy_loss, 10, 10,
           "of each swing's kinetic energy as much is lost as the turning points are lower",
           "a body on prescribed energies") {
  const Scene s = sheet();
  std::vector<State> states;
  for (int n = 0; n <= 130; ++n) {  // three swings of 40 steps, and part of a fourth
    const double moves = std::pow(std::sin(std::numbers::pi * n / 40), 2);  // J/kg
    State state = s.start;
    for (Vec3& v : state.v) v.x() = std::sqrt(2 * moves);
    for (Vec3& x : state.x) x.y() += (-0.1 * n / 40 - moves) / kG;
    states.push_back(state);
  }
  findings.equal("metric:energy_loss", "energy.loss of a body that loses a tenth in each swing",
                 "1", measured("energy.loss", s, states), 0.1, 1e-12);
}

TAUT_TRUTH(metric_pins, 10, 11, "pins carry the weight of a cloth at rest",
           "momentum balance of the whole cloth") {
  Scene s = sheet();
  s.pins = {0, 4};
  findings.equal("metric:pins", "pins.force of a cloth at rest", "1",
                 measured("pins.force", s, {s.start, s.start}), 1, 1e-14);
  std::vector<State> lifted(65, s.start);
  for (std::size_t n = 0; n < lifted.size(); ++n)
    for (Vec3& v : lifted[n].v) v.y() = 2 * static_cast<double>(n) * s.dt;
  const double pinned = (s.mesh.mass[0] + s.mesh.mass[4]) / 0.2;
  findings.equal("metric:pins", "the same, lifted ever faster at 2 m/s^2", "1",
                 measured("pins.force", s, lifted), 1 + (1 - pinned) * 2 / kG, 1e-12);
}

TAUT_TRUTH(metric_principal, 10, 12,
           "simple shear by k has sigma = sqrt(1 + k^2/4) +- k/2 and strains no weft",
           "linear algebra") {
  const Scene s = sheet();
  const double k = 0.6;
  State sheared = s.start;
  for (Vec3& x : sheared.x) x.x() -= k * x.y();  // v points down
  const auto check = [&](const char* name, double expected) {
    findings.equal("metric:principal", std::string(name) + " in simple shear by 0.6", "1",
                   measured(name, s, {sheared, sheared}), expected, 1e-14);
  };
  check("principal.first.p50", std::sqrt(1 + k * k / 4) + k / 2 - 1);
  check("principal.second.p95", 1 - std::sqrt(1 + k * k / 4) + k / 2);
  check("principal.weft.max", 0);
  check("principal.warp.max", std::sqrt(1 + k * k) - 1);
  check("principal.bias.p50", std::hypot(1 + k, 1) / std::sqrt(2.0) - 1);
}

TAUT_TRUTH(metric_path, 10, 13,
           "a cloth that is late has the delay as its phase, a frozen one has travelled nothing",
           "a prescribed path beside itself") {
  Scene s = sheet();
  s.pins = {0};  // it rests, and with it a cloth that stands still
  const auto place = [&](double t) {
    State state = s.start;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const Vec3 way(0.1, 0.02 * static_cast<double>(i), -0.3);
      state.x[i] += (1 - std::cos(2 * t)) * way;
      state.v[i] = 2 * std::sin(2 * t) * way;
    }
    return state;
  };
  Scene longer = s;
  longer.steps = 128;
  const auto path = [&](double speed, double late) {
    MotionReference reference{.derivation = "closed form", .horizon = 1};
    for (int k = 0; k <= 32; ++k) reference.states.push_back(place(k / 32.0));
    ReferencePath result(longer, reference);
    for (int n = 0; n <= longer.steps; ++n) {
      const State state = place(speed * n * s.dt - late);
      result.observe({n, n * s.dt, state});
    }
    return result;
  };
  // sums over the moments of products of the factors 1 - cos
  const auto factor = [](double t) { return 1 - std::cos(2 * t); };
  double along = 0, way = 0, apart = 0, square = 0;
  for (int k = 1; k <= 32; ++k) {
    const double t = k / 32.0, before = (k - 1) / 32.0, move = factor(t) - factor(before);
    along += move * (factor(t / 2) - factor(before / 2));
    way += move * move;
    apart += std::pow(factor(t / 2) - factor(t), 2);
    square += std::pow(factor(t), 2);
  }
  findings.equal("metric:reference", "motion.share of the path itself", "1", path(1, 0).share(), 1,
                 1e-14);
  findings.equal("metric:reference", "motion.phase of the same path 0.2 s later", "s",
                 path(1, 0.2).phase(), 0.2, 1e-4);
  findings.equal("metric:reference", "motion.share at half the speed", "1", path(0.5, 0).share(),
                 along / way, 1e-14);
  findings.equal("metric:reference", "motion.error at half the speed", "1", path(0.5, 0).error(),
                 std::sqrt(apart / square), 1e-12);
  findings.equal("metric:reference", "motion.share of a frozen cloth", "1", path(0, 0).share(), 0,
                 0);
  findings.equal("metric:reference", "motion.error of a frozen cloth", "1", path(0, 0).error(), 1,
                 0);
}

TAUT_TRUTH(metric_mode, 10, 14,
           "a damped swing has its damping ratio; under k sweeps that of z^2 - 2 mu z + mu = 0",
           "logarithmic decrement; linearised Gauss-Seidel sweeps about the hanging chain") {
  const int n = 8;
  Scene s = under_gravity(bare::chain(n, 1, 0.1));
  s.mesh.grid = Grid{1, n + 1};
  const double w = reference::hanging_chain_frequencies(n, 1, kG)[0], ratio = 0.02;
  const std::vector<double> shape = reference::hanging_chain_mode(n, 1);
  std::vector<State> swing;
  for (int step = 0; step <= 1280; ++step) {
    const double t = step * s.dt, decay = ratio / std::sqrt(1 - ratio * ratio) * w;
    State state = s.start;
    for (std::size_t i = 0; i < shape.size(); ++i)
      state.x[i + 1].x() += 0.01 * shape[i] * std::exp(-decay * t) * std::cos(w * t);
    swing.push_back(state);
  }
  Scene let_go = s;
  let_go.start = swing[0];
  findings.equal("metric:mode", "mode.damping of a swing of 2 %", "1",
                 measured("mode.damping", let_go, swing), ratio, 1e-5);
  findings.equal("metric:mode", "mode.period of the same swing", "1",
                 measured("mode.period", let_go, swing), 0, 1e-5);
  for (const int k : {16, 64, 1500}) {
    const reference::Modes modes =
        reference::modes(reference::transverse_sweeps(n, k, kG * s.dt * s.dt, 1.0 / n));
    Eigen::Index lowest = 0;
    modes.eigenvalues.cwiseAbs().maxCoeff(&lowest);
    const double mu = modes.eigenvalues[lowest].real(), decay = -std::log(mu) / 2,
                 angle = std::acos(std::sqrt(mu));  // of a step
    const std::string at = ", 8 links, " + std::to_string(k) + " sweeps";
    for (const std::string& solver : {jakobsen(k), bullet(k)}) {
      if (!can_run(findings, solver, let_go)) continue;
      Simulation sim(let_go, solver);
      std::vector<State> states{let_go.start};
      for (int step = 0; step < 640; ++step) {
        sim.step();
        states.push_back(sim.state());
      }
      findings.equal(solver, "mode.damping" + at, "1", measured("mode.damping", let_go, states),
                     decay / std::hypot(decay, angle), 1e-4);
      findings.equal(solver, "mode.period" + at, "1", measured("mode.period", let_go, states),
                     w * s.dt / angle - 1, 1e-4);
    }
  }
}

TAUT_TRUTH(metric_creep, 10, 15,
           "creep is the speed along a body that moves and turns, of vertices that touch it for a "
           "whole second",
           "a prescribed path on a turning box") {
  Scene s = under_gravity(bare::scene({Vec3(0.1, 0, 0), Vec3(0, 0, 0.2)}, {1, 1}, {}));
  const Motion motion{.velocity = {0.5, 0.1, 0}, .spin = {0.3, -1, 0.2}, .pivot = {0.2, 0, 0.1}};
  const auto slides = [&](double speed, double friction, double height) {
    Scene rough = s;
    rough.colliders = {{Box{Vec3(0, -0.1, 0), Vec3(1, 0.1, 1)}, motion, friction}};
    std::vector<State> states(129, s.start);
    for (std::size_t n = 0; n < states.size(); ++n) {
      const double t = static_cast<double>(n) * s.dt;
      for (Vec3& x : states[n].x) x = motion.moved(x + Vec3(0, height * t, 0), t);
      states[n].x[0] = motion.moved(s.start.x[0] + Vec3(0, height, speed) * t, t);
    }
    return measured("contact.creep", rough, states);
  };
  findings.equal("metric:contact_creep", "contact.creep of a vertex at 3 mm/s on a turning box",
                 "m/s", slides(3e-3, 0.2, 0), 3e-3, 1e-13);
  findings.below("metric:contact_creep", "of vertices that it carries along", "m/s",
                 slides(0, 0.2, 0), 1e-13);
  findings.holds("metric:contact_creep", "no value without friction",
                 std::isnan(slides(3e-3, 0, 0)));
  findings.holds("metric:contact_creep", "no value of vertices that leave the box at 0.1 m/s",
                 std::isnan(slides(3e-3, 0.2, 0.1)));
}

}  // namespace taut
