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
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (p.w[i] == 0) continue;
      const Surface s = surface(shape, p.x[i].template cast<double>());
      if (s.distance >= thickness_) continue;
      const Vec3 out = (thickness_ - s.distance) * s.normal;
      p.x.add(i, out.cast<Real>());
    }
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "collide " + std::string(type_name(collider_.shape)),
             .items = particles_,
             .bytes = sizeof(*this)}};
  }

 private:
  Collider collider_;
  double thickness_;
  std::size_t particles_;
};

}  // namespace taut
