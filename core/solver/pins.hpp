#pragma once

#include <algorithm>
#include <vector>

#include "core/model/scene.hpp"
#include "core/solver/particles.hpp"

namespace taut {

/// The vertices that are not integrated: held, or moved along the scene's motions.
class Pins {
 public:
  explicit Pins(const Scene& scene) : held_(scene.pins), motions_(scene.pin_motions) {
    for (const PinMotion& group : motions_)
      for (const int v : group.vertices) {
        std::erase(held_, v);
        starts_.push_back(scene.start.x[static_cast<std::size_t>(v)]);
      }
  }

  /// Undoes what integration did to them and puts them where they have to be at time t [s].
  template <class Real>
  void place(Particles<Real>& p, double t) const {
    for (const int v : held_)
      p.x.set(static_cast<std::size_t>(v), p.previous[static_cast<std::size_t>(v)]);
    std::size_t next = 0;
    for (const PinMotion& group : motions_)
      for (const int v : group.vertices)
        p.x.set(static_cast<std::size_t>(v),
                group.motion.moved(starts_[next++], t).template cast<Real>());
  }

  bool empty() const { return held_.empty() && motions_.empty(); }
  std::size_t size() const { return held_.size() + starts_.size(); }
  std::size_t bytes() const { return held_.size() * sizeof(int) + starts_.size() * sizeof(Vec3); }

 private:
  std::vector<int> held_;
  std::vector<PinMotion> motions_;
  std::vector<Vec3> starts_;  ///< m, of the moved ones, group after group
};

}  // namespace taut
