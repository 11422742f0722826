#pragma once

#include "core/model/scene.hpp"
#include "core/solver/contact/place.hpp"
#include "core/solver/pass.hpp"
#include "core/solver/simd/kernels.hpp"

namespace taut {

/// Moves every particle that is inside a collider out of it (report, sections 4.2.1 to 4.2.3).
/// `swept` also catches those that passed through it since the step began. No particle sees
/// another, so they are taken as they lie in memory, some at once; pins are put back afterwards.
template <class Real, template <class> class SurfaceOf>
class CollidePass final : public Pass<Real> {
 public:
  CollidePass(const Collider& collider, const Scene& scene, bool swept, Simd simd)
      : collider_(collider, scene.thickness),
        collide_(choose(kernels<Real>(simd).collide, swept)),
        kind_(type_name(collider.shape)),
        particles_(scene.start.x.size()),
        pins_(scene.pins.begin(), scene.pins.end()),
        pinned_(pins_.size()) {}

  void begin(Particles<Real>&, double t, double dt) override { contact_ = collider_.at(t, dt); }

  void apply(Particles<Real>& p, double, double) override {
    for (std::size_t k = 0; k < pins_.size(); ++k) pinned_[k] = p.x[pins_[k]];
    const std::size_t lanes = p.layout->stride();
    const std::size_t count = lanes > 1 ? p.layout->length() / (3 * lanes) : p.size();
    collide_(contact_, {p.x.data(), p.previous.data(), lanes, count});
    for (std::size_t k = 0; k < pins_.size(); ++k) p.x.set(pins_[k], pinned_[k]);
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "collide " + kind_,
             .items = particles_,
             .bytes = sizeof(*this) + pins_.size() * (sizeof pins_[0] + sizeof pinned_[0])}};
  }

 private:
  static Collide<Real, SurfaceOf> choose(const CollideKernels<Real>& kernels, bool swept) {
    if constexpr (std::is_same_v<SurfaceOf<Real>, PlaneSurface<Real>>)
      return kernels.plane;
    else if constexpr (std::is_same_v<SurfaceOf<Real>, BallSurface<Real>>)
      return swept ? kernels.ball_swept : kernels.ball;
    else
      return swept ? kernels.box_swept : kernels.box;
  }

  ColliderInMotion<Real, SurfaceOf> collider_;
  Collide<Real, SurfaceOf> collide_;
  std::string kind_;
  std::size_t particles_;
  std::vector<std::size_t> pins_;
  std::vector<typename Points<Real>::Point> pinned_;  ///< where they are meanwhile [m]
  Contact<Real, SurfaceOf> contact_{};
};

}  // namespace taut
