#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/model/params.hpp"
#include "core/model/scene.hpp"
#include "core/model/vec3.hpp"
#include "core/solver/contact/responses.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/coulomb.hpp"

namespace taut {

/// Contact force of a collider on a vertex.
struct ContactForce {
  double push = 0;          ///< N, along the normal, >= 0
  Vec3 rub = Vec3::Zero();  ///< N, friction, across the normal
  bool holds() const { return push > 0; }
};

/// A vertex at a collider, linearised where the vertex is: the half-space normal . x >= offset.
struct TouchingVertex {
  std::size_t vertex = 0, collider = 0;
  Vec3 normal = Vec3::UnitY();
  double offset = 0;         ///< m, of the collider and the scene's thickness
  Vec3 from = Vec3::Zero();  ///< m, position if it had moved with the collider in this substep
  double friction = 0;
  bool nearest = true;  ///< touches the surface nearest to the vertex, not where it came in

  double gap(const Vec3& x) const { return normal.dot(x) - offset; }
  Vec3 across(const Vec3& v) const { return v - normal.dot(v) * normal; }
  Vec3 slip(const Vec3& x) const { return across(x - from); }
  Vec3 total(const ContactForce& f) const { return f.push * normal + f.rub; }
  FrictionCone<double> cone(const Vec3& rub, double push) const {
    return {rub.norm(), friction * push};
  }
};

/// A vertex at a collider in the iterations of one substep.
struct MetInSubstep {
  Vec3 side = Vec3::Zero();  ///< normal with which it was last found; 0: not found yet
  bool pushed = false;       ///< has been given a first force
};

/// Displacement of a vertex per force [m/N]: the same in all directions, or a matrix.
struct IsotropicCompliance {
  double value;
  Vec3 operator*(const Vec3& force) const { return value * force; }
  Vec3 force_for(const Vec3& way) const { return way / value; }
  /// The force on a vertex that slips and would be at `free` without it.
  ContactForce slipping(const TouchingVertex& at, const Vec3& free) const {
    const ContactForce force{-at.gap(free) / value, -at.slip(free) / value};
    return {force.push, at.cone(force.rub, force.push).share() * force.rub};
  }
};
struct MatrixCompliance {
  Eigen::Matrix3d value, inverse;  ///< symmetric
  Vec3 operator*(const Vec3& force) const { return value * force; }
  Vec3 force_for(const Vec3& way) const { return inverse * way; }
  /// As above. A compliance that differs by direction couples push and friction r. Without the
  /// push, whose gap is 0, the slip is s + S r in the plane of contact; friction against it is
  ///
  ///     r = -(S + lambda I)^-1 s,    |r(lambda)| = mu push(r(lambda)),    lambda >= 0
  ///
  /// which is one equation for lambda, solved as that of a trust region: Newton's method for the
  /// inverse of |r|, which is nearly linear (More, Sorensen 1983), between bounds.
  ContactForce slipping(const TouchingVertex& at, const Vec3& free) const;
};

/// Changes the force so that x, which it moves by `compliance`, keeps out of the half-space and
/// obeys Coulomb. There is no force if x is outside without one. Otherwise x sticks while friction
/// is at most mu times the push, and beyond that slips against it. Moves x and returns the change
/// [N].
template <class Compliance>
Vec3 settle(const TouchingVertex& at, const Compliance& compliance, ContactForce& force, Vec3& x) {
  const Vec3 before = at.total(force);
  const Vec3 free = x - compliance * before;
  const auto leave = [&](const ContactForce& now) {
    force = now;
    const Vec3 change = at.total(now) - before;
    x += compliance * change;
    return change;
  };
  if (at.gap(free) >= 0) return leave({});
  if (at.friction == 0)
    return leave({-at.gap(free) / at.normal.dot(compliance * at.normal), Vec3::Zero()});
  const Vec3 sticking = compliance.force_for(-at.slip(free) - at.gap(free) * at.normal);
  const ContactForce stuck{at.normal.dot(sticking), at.across(sticking)};
  const bool sticks = stuck.push > 0 && at.cone(stuck.rub, stuck.push).sticks();
  return leave(sticks ? stuck : compliance.slipping(at, free));
}

/// Contact as a constraint, for solvers that solve towards y. The forces of every vertex, by
/// collider, are kept from iteration to iteration and from substep to substep while they hold, so
/// that links feel the push of the collider. Projection after a solve without the collider would
/// come to rest where links carry too little: at an edge it is off by more than g h^2 however often
/// it is repeated.
///
/// The conditions are those of one step of implicit Euler with Signorini and Coulomb contact,
///
///     0 <= push, 0 <= gap, push gap = 0;   |rub| <= mu push, against the slip where it is equal.
class Contacts {
 public:
  class Surface;  ///< a collider in a substep
  Contacts(const Scene&, bool continuous);
  ~Contacts();

  void restart();  ///< forgets all forces and the last substep
  /// Takes over the forces at the same colliders.
  void take_over(const Contacts& before) { forces_ = before.forces_; }
  /// Begins the substep [t, t + h]: colliders move, and forces turn with them.
  void begin(double t, double h);

  /// Whether the collider holds the vertex at x, which began the substep at `previous`, or x is
  /// inside it. If so, sets where it touches.
  bool touches(std::size_t vertex, std::size_t collider, const Vec3& x, const Vec3& previous,
               TouchingVertex&, const MetInSubstep& = {});
  std::size_t colliders() const { return surfaces_.size(); }
  ContactForce& force(std::size_t vertex, std::size_t collider) {
    return forces_[vertex * surfaces_.size() + collider];
  }
  /// Finds all contacts of vertices that are not pinned. met: null, or [vertex][collider], by which
  /// a contact that was found once is found until the substep ends, on the same side.
  template <class Real>
  void find(const Particles<Real>& p, std::vector<TouchingVertex>&,
            std::vector<MetInSubstep>* met = nullptr);
  /// Lays the half-space where the surface is nearest to x, if it is of that kind.
  void lay(TouchingVertex&, const Vec3& x);

  /// The initial guess of sweeps: each touching vertex leaves the collider and undoes its slip as
  /// if it had no links. A sheet that lands flat needs no more. Forces that already hold a vertex
  /// stay as they are where there is no gap and no slip.
  template <class Real>
  void predict(Particles<Real>& p, double h);
  /// Sets the forces of new contacts as if there were no links. Does not change p.x, which holds y.
  template <class Real>
  void predict_new(const Particles<Real>& p, double h);

  /// Sum of the forces [N] on a vertex at x, linearised there.
  Vec3 force_at(std::size_t vertex, const Vec3& x, const Vec3& previous);
  /// Settles the contacts of a vertex that has been moved to x, if it has any. hessian(): of its
  /// energy [N/m].
  template <class Hessian>
  void settle_vertex(std::size_t vertex, const Hessian& hessian, const Vec3& previous, Vec3& x) {
    std::optional<MatrixCompliance> moves;  // computed only on contact: few vertices touch anything
    constexpr int kRounds = 8;  // for a vertex at several colliders, whose forces affect each other
    for (int round = 0; round < kRounds; ++round) {
      int touching = 0;
      TouchingVertex at;
      for (std::size_t k = 0; k < surfaces_.size(); ++k)
        if (touches(vertex, k, x, previous, at)) {
          ++touching;
          if (!moves) {
            const Eigen::Matrix3d stiffness = hessian();
            moves = {stiffness.inverse(), stiffness};
          }
          settle(at, *moves, force(vertex, k), x);
        }
      if (touching < 2) return;
    }
  }

  std::size_t bytes() const { return forces_.size() * sizeof(ContactForce); }

 private:
  std::vector<std::unique_ptr<Surface>> surfaces_;
  std::vector<ContactForce> forces_;  ///< [vertex][collider]
};

/// The contacts of a scene; null if there is no collider, or if `contact` is neither continuous nor
/// discrete.
std::unique_ptr<Contacts> make_contacts(const Scene&, const Params&);

}  // namespace taut
