#pragma once

#include "core/solver/pass.hpp"

namespace taut {

/// Moves every particle that is inside a collider to its surface (report, sections 4.2.1 to 4.2.3).
template <class Real>
class CollidePass final : public Pass<Real> {
 public:
  CollidePass(const Collider& collider, double thickness, std::size_t particles)
      : collider_(collider), thickness_(thickness), particles_(particles) {}

  void apply(Particles<Real>& p, double t, double dt) override {
    const Shape shape = shape_at(collider_, t + dt);
    for (Vec4<Real>& x : p.x) {
      if (x.w == 0) continue;
      const Surface s = surface(shape, {x.x, x.y, x.z});
      if (s.distance >= thickness_) continue;
      const Vec3 out = (thickness_ - s.distance) * s.normal;
      x.x += static_cast<Real>(out.x()), x.y += static_cast<Real>(out.y()),
          x.z += static_cast<Real>(out.z());
    }
  }

  PassCost cost() const override {
    return {.pass = "collide " + std::string(type_name(collider_.shape)),
            .items = particles_,
            .bytes = sizeof(*this)};
  }

 private:
  Collider collider_;
  double thickness_;
  std::size_t particles_;
};

}  // namespace taut
