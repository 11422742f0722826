#include "experiments/metrics/own_way.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/model/index.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

constexpr double kFirst = 1.3;
constexpr int kFirstWithoutGravity = 32;

}  // namespace

int first_steps(const Scene& scene) {
  const double g = scene.gravity.norm();
  const double steps =
      g > 0 ? kFirst * std::sqrt(extent(scene) / g) / scene.dt : kFirstWithoutGravity;
  return static_cast<int>(std::lround(std::min<double>(steps, scene.steps)));
}

std::string first_time_text() {
  const double square_metre = kFirst * std::sqrt(std::numbers::sqrt2 / 9.81);
  return "T = " + as_typed(kFirst) + " sqrt(size/g), " +
         as_typed(std::round(10 * square_metre) / 10) + " s for a square metre";
}

Vec3 way_of_pins(const Scene& scene, double t) {
  Vec3 sum = Vec3::Zero();
  for (const int pin : scene.pins)
    sum += pin_position(scene, pin, t) - scene.start.x[static_cast<std::size_t>(pin)];
  return sum / static_cast<double>(scene.pins.size());
}

Vec3 weighted_mean(const Scene& scene, const std::vector<Vec3>& all) {
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    sum += scene.mesh.mass[i] * all[i];
    mass += scene.mesh.mass[i];
  }
  return sum / mass;
}

void keep_own_way(const Scene& scene, double t, std::vector<Vec3>& ways) {
  const Vec3 common = scene.pins.empty() ? weighted_mean(scene, ways) : way_of_pins(scene, t);
  for (Vec3& way : ways) way -= common;
}

}  // namespace taut
