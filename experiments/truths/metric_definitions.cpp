// Section 10: metrics on states whose values are known by construction.
#include <cmath>
#include <map>

#include "core/model/index.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/truths/simulation.hpp"

namespace taut {

namespace {

/// What the named metric gives for a run through these states.
std::map<std::string, double> measure(std::string_view name, Scene scene,
                                      const std::vector<State>& states) {
  scene.steps = static_cast<int>(states.size()) - 1;
  for (const MetricEntry* entry : metrics()) {
    if (entry->name != name) continue;
    const auto metric = entry->make(scene);
    if (!metric) return {};
    for (int n = 0; n <= scene.steps; ++n) metric->observe({n, n * scene.dt, states[to_index(n)]});
    const std::vector<double> numbers = metric->finish();
    std::map<std::string, double> values;
    for (std::size_t i = 0; i < numbers.size(); ++i)
      values[std::string(entry->values[i].name)] = numbers[i];
    return values;
  }
  return {};
}

double value(const std::map<std::string, double>& values, const std::string& name) {
  const auto found = values.find(name);
  return found == values.end() ? std::nan("") : found->second;
}

Scene sheet() {
  Scene s = under_gravity(bare::sheet(5, 5, {.shear = true, .bend = true}));
  return s;
}

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
  const auto stretched = measure("stretch", s, {still(wide), still(wide)});
  for (const char* name : {"stretch.rms", "stretch.max", "stretch.p95", "stretch.peak",
                           "structural.rms", "shear.max", "bend.rms"})
    findings.equal("metric:stretch", std::string(name) + " of a sheet 10 % too large", "1",
                   value(stretched, name), 0.1, 1e-14);
  const auto pressed = measure("stretch", s, {still(narrow), still(narrow)});
  findings.equal("metric:stretch", "compression.max of a sheet 20 % too small", "1",
                 value(pressed, "compression.max"), 0.2, 1e-14);
  const auto area = measure("area", s, {still(wide), still(wide)});
  findings.equal("metric:area", "area.rms of a sheet 10 % too large", "1", value(area, "area.rms"),
                 0.21, 1e-13);
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
  const auto values = measure("energy", s, falling);
  findings.below("metric:energy", "energy of a body in free fall, per m g L", "1",
                 std::abs(value(values, "energy.mean")), 1e-13);
  // mean of (g t)^2/2 over the last second, in m g L with L = sqrt(2)
  double kinetic = 0;
  int count = 0;
  for (int n = 65; n <= 128; ++n, ++count) kinetic += std::pow(kG * n * s.dt, 2) / 2;
  findings.equal("metric:energy", "its kinetic part over the last second", "1",
                 value(values, "energy.kinetic"), kinetic / count / (kG * std::sqrt(2.0)), 1e-9);
}

TAUT_TRUTH(metric_motion, 10, 3, "jitter, popping, drift and settling of prescribed motions",
           "their definitions") {
  const Scene s = sheet();
  State steady = s.start;
  for (Vec3& v : steady.v) v = Vec3(0.3, 0, 0.4);
  const auto jitter = measure("jitter", s, {steady, steady, steady});
  findings.equal("metric:jitter", "jitter.rms of a sheet at 0.5 m/s", "m/s",
                 value(jitter, "jitter.rms"), 0.5, 1e-14);
  std::vector<State> jump(4, s.start);
  for (Vec3& x : jump[2].x) x.z() += 0.01;  // out and back within a step
  const auto popping = measure("popping", s, jump);
  findings.equal("metric:popping", "popping.peak of a jump by 1 cm and back", "m/s^2",
                 value(popping, "popping.peak"), 0.02 / s.dt / s.dt - kG, 1e-9);
  std::vector<State> moved(2, s.start);
  for (Vec3& x : moved[1].x) x += Vec3(3, 0, 4);
  findings.equal("metric:drift", "drift.max of a sheet moved by 5 m", "m",
                 value(measure("drift", s, moved), "drift.max"), 5, 1e-13);
  std::vector<State> slows(65, s.start);
  for (std::size_t n = 0; n < 32; ++n)
    for (Vec3& v : slows[n].v) v.x() = 1;
  findings.equal("metric:settle", "settle.time of a sheet that stops after step 31", "s",
                 value(measure("settle", s, slows), "settle.time"), 31 * s.dt, 1e-14);
}

TAUT_TRUTH(metric_penetration, 10, 4, "penetration is max(0, -signed distance)",
           "a vertex placed 3 cm deep") {
  Scene s = under_gravity(bare::scene({Vec3(0, 0.47, 0), Vec3(0, 2, 0)}, {1, 1}, {}));
  const auto depth = [&](const Shape& shape) {
    Scene with_shape = s;
    with_shape.colliders.push_back({shape, {}, 0});
    return value(measure("penetration", with_shape, {s.start, s.start}), "penetration.max");
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
  const auto values = measure("faces", s, {s.start, s.start});
  findings.equal("metric:faces", "face.max of a face with its corners on a ball", "m",
                 value(values, "face.max"), 1.2516e-3, 5e-8);
  findings.equal("metric:faces", "face.geometry of the same face", "m",
                 value(values, "face.geometry"), radius - height, 1e-12);
  findings.below("metric:faces", "face.excess of the same face", "m",
                 std::abs(value(values, "face.excess")), 1e-12);
}

TAUT_TRUTH(metric_tunnelling, 10, 6,
           "vertices that end on the other side are counted, even within one step",
           "a vertex through a ball's centre") {
  Scene s = under_gravity(bare::scene({Vec3(0, 1, 0), Vec3(3, 1, 0)}, {1, 1}, {}));
  s.colliders.push_back({Ball{Vec3::Zero(), 0.3}, {}, 0});
  std::vector<State> states(2, s.start);
  for (Vec3& x : states[1].x) x.y() = -1;  // one through the middle, one past it
  findings.equal("metric:tunnelling", "tunnelling.count of one vertex through and one past", "1",
                 value(measure("tunnelling", s, states), "tunnelling.count"), 1, 0);
}

TAUT_TRUTH(metric_crossings, 10, 7, "crossing faces that share no vertex are counted",
           "two triangles") {
  Scene s = bare::scene({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.2, 0.2, -1),
                         Vec3(0.2, 0.2, 1), Vec3(-1, -1, 3)},
                        std::vector<double>(6, 1.0), {});
  s.mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  s.self_collision = SelfCollision{0.01};
  const auto crossing = measure("self_intersection", s, {s.start, s.start});
  State apart = s.start;
  for (const std::size_t i : {3u, 4u, 5u}) apart.x[i].z() += 10;
  const auto clear = measure("self_intersection", s, {apart, apart});
  findings.equal("metric:self_intersection", "self.crossings of two crossing faces", "1",
                 value(crossing, "self.crossings"), 1, 0);
  findings.equal("metric:self_intersection", "of two faces apart", "1",
                 value(clear, "self.crossings"), 0, 0);
}

}  // namespace taut
