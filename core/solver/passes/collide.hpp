#pragma once

#include "core/solver/contact/carry.hpp"
#include "core/solver/contact/surfaces.hpp"
#include "core/solver/pass.hpp"

namespace taut {

/// A collider as one step sees it, and what it does to a particle.
template <class Real, template <class> class SurfaceOf>
class Contact {
 public:
  using Point = Eigen::Matrix<Real, 3, 1>;
  using Surface = SurfaceOf<Real>;

  Contact(const Collider& collider, double thickness)
      : collider_(collider),
        thickness_(static_cast<Real>(thickness)),
        friction_(static_cast<Real>(collider.friction)) {}

  /// For the step [t, t + dt].
  void place(double t, double dt) {
    surface_ = Surface(std::get<typename Surface::Shape>(shape_at(collider_, t + dt)));
    carry_ = Carry<Real>(collider_.motion, t, dt);
  }

  [[gnu::always_inline]] bool clear(const Point& x) const { return surface_.clear(x, thickness_); }

  /// Moves x out to the nearest point at the scene's thickness, then against its slip since
  /// `previous`. False if it was outside.
  [[gnu::always_inline]] bool project(Point& x, const Point& previous) const {
    return push(x, previous, surface_.nearest(x));
  }

  /// The same, but back to the side from which the particle came in, even if it has passed through
  /// since.
  [[gnu::always_inline]] bool project_swept(Point& x, const Point& previous) const {
    const Point from = carry_(previous);
    if (surface_.beyond(x, (x - from).squaredNorm(), thickness_)) return false;
    if (surface_.misses(from, x)) return !clear(x) && project(x, previous);
    const auto entry = surface_.entry(from, x);
    if (!entry) return !clear(x) && project(x, previous);
    const Tangent<Real> nearest = surface_.nearest(x);
    const bool same_side = !surface_.clear(x, 0) && nearest.normal.dot(entry->normal) > 0;
    return push(x, previous, same_side ? nearest : *entry);
  }

 private:
  /// Coulomb: the tangential correction is at most mu times the normal one, and no more than the
  /// slip itself.
  [[gnu::always_inline]] bool push(Point& x, const Point& previous,
                                   const Tangent<Real>& tangent) const {
    const Real depth = tangent.offset + thickness_ - tangent.normal.dot(x);
    if (!(depth > 0)) return false;
    x += depth * tangent.normal;
    if (friction_ == 0) return true;
    Point slip = x - carry_(previous);
    slip -= tangent.normal.dot(slip) * tangent.normal;
    const Real length = slip.norm(), most = friction_ * depth;
    x -= length <= most ? slip : Point(most / length * slip);
    return true;
  }

  Collider collider_;
  Real thickness_, friction_;
  Surface surface_;
  Carry<Real> carry_;
};

/// Moves every particle that is inside a collider out of it (report, sections 4.2.1 to 4.2.3).
/// `swept` also catches those that passed through it since the step began.
template <class Real, template <class> class SurfaceOf, bool swept>
class CollidePass final : public Pass<Real> {
 public:
  CollidePass(const Collider& collider, double thickness, std::size_t particles)
      : contact_(collider, thickness), kind_(type_name(collider.shape)), particles_(particles) {}

  void begin(Particles<Real>&, double t, double dt) override { contact_.place(t, dt); }

  void apply(Particles<Real>& p, double, double) override {
    for (std::size_t i = 0; i < p.size(); ++i) {
      typename Points<Real>::Point x = p.x[i];
      if constexpr (swept) {
        if (p.w[i] != 0 && contact_.project_swept(x, p.previous[i])) p.x.set(i, x);
      } else {
        if (contact_.clear(x) || p.w[i] == 0) continue;
        if (contact_.project(x, p.previous[i])) p.x.set(i, x);
      }
    }
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "collide " + kind_, .items = particles_, .bytes = sizeof(*this)}};
  }

 private:
  Contact<Real, SurfaceOf> contact_;
  std::string kind_;
  std::size_t particles_;
};

}  // namespace taut
