#include "experiments/metrics/own_way.hpp"

#include "core/model/index.hpp"

namespace taut {

namespace {

/// Mean displacement [m] of the pins until time t, which carries the cloth along.
Vec3 way_of_pins(const Scene& scene, double t) {
  Vec3 sum = Vec3::Zero();
  for (const int pin : scene.pins)
    sum += pin_position(scene, pin, t) - scene.start.x[static_cast<std::size_t>(pin)];
  return sum / static_cast<double>(scene.pins.size());
}

/// Mean over vertices, weighted by their masses.
Vec3 weighted_mean(const Scene& scene, const std::vector<Vec3>& all) {
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    sum += scene.mesh.mass[i] * all[i];
    mass += scene.mesh.mass[i];
  }
  return sum / mass;
}

}  // namespace

void keep_own_way(const Scene& scene, double t, std::vector<Vec3>& ways) {
  const Vec3 common = scene.pins.empty() ? weighted_mean(scene, ways) : way_of_pins(scene, t);
  for (Vec3& way : ways) way -= common;
}

}  // namespace taut
