// Section 10: metrics on states whose values are known by construction.
#include <cmath>

#include "core/model/index.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

namespace {

/// A metric's value for a run through these states; NaN: it has none for this scene.
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
                           "structural.rms", "shear.max", "bend.rms"})
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
    for (std::size_t i = 0; i < state.x.size(); ++i)
      state.x[i] += s.gravity * t * t / 2, state.v[i] = s.gravity * t;
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
}

TAUT_TRUTH(metric_tunnelling, 10, 6,
           "vertices that end on the other side are counted, even within one step",
           "a vertex through a ball's centre") {
  Scene s = under_gravity(bare::scene({Vec3(0, 1, 0), Vec3(3, 1, 0)}, {1, 1}, {}));
  s.colliders.push_back({Ball{Vec3::Zero(), 0.3}, {}, 0});
  std::vector<State> states(2, s.start);
  for (Vec3& x : states[1].x) x.y() = -1;  // one through the middle, one past it
  findings.equal("metric:tunnelling", "tunnelling.count of one vertex through and one past", "1",
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

}  // namespace taut
