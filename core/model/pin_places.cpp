#include "core/model/pin_places.hpp"

#include <algorithm>
#include <limits>

#include "core/model/index.hpp"

namespace taut {

PinPlaces::PinPlaces(const Scene& scene) : dt_(scene.dt), extent_(extent(scene)) {
  const auto pin = [&](int vertex) {
    int until = std::numeric_limits<int>::max();
    for (const Release& r : scene.releases)
      if (std::ranges::binary_search(r.vertices, vertex)) until = r.step;
    return Pin{vertex, until, scene.start.x[to_index(vertex)]};
  };
  std::vector<int> still = scene.pins;
  for (const auto& [vertices, motion] : scene.pin_motions) {
    Group& group = groups_.emplace_back(Group{motion, {}});
    for (const int v : vertices) {
      group.pins.push_back(pin(v));
      std::erase(still, v);
    }
  }
  if (still.empty()) return;
  Group& group = groups_.emplace_back();
  for (const int v : still) group.pins.push_back(pin(v));
}

PinPlaces::Stray PinPlaces::farthest(int step, const std::vector<Vec3>& x, double within,
                                     double rounding) const {
  Stray stray;
  for (const auto& [motion, pins] : groups_) {
    const double t = step * dt_;
    const Eigen::Matrix3d turn = motion.rotation(t).toRotationMatrix();
    const Vec3 shift = motion.displacement(t);
    const double size = extent_ + motion.pivot.norm() + shift.norm();
    for (const auto& [vertex, until, start] : pins) {
      const Vec3& at = x[to_index(vertex)];
      if (step > until || !at.allFinite()) continue;
      const Vec3 place = motion.spin.isZero(0)
                             ? Vec3(start + shift)
                             : Vec3(motion.pivot + turn * (start - motion.pivot) + shift);
      const double distance = (at - place).norm();
      if (distance <= std::max(stray.distance, within + rounding * (size + start.norm()))) continue;
      stray = {vertex, distance, place};
    }
  }
  return stray;
}

}  // namespace taut
