#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "core/solver/contact/contacts.hpp"
#include "core/solver/loop.hpp"
#include "core/solver/newton/hessian.hpp"

namespace taut::solver::implicit {

/// Contact as an augmented Lagrangian at each vertex that touches (Alart, Curnier, Computer Methods
/// in Applied Mechanics and Engineering 92, 1991): with the force of the last iteration, push along
/// the normal n and rub across it, and a stiffness k,
///
///     push' = max(0, push - k gap),   rub' = rub - k slip, no longer than mu push
///
/// act, k n n^T + k (I - n n^T) join the Hessian where they hold and stick. They become the forces
/// once the gradient that is left is less than a share of their change: sooner, and contacts would
/// take turns at sticking and slipping without end.
class AugmentedContacts {
 public:
  explicit AugmentedContacts(const loop::Setup& s)
      : contacts_(make_contacts(s.scene, s.params)), stiffness_(contacts_ ? s.w.size() : 0) {}

  void forget();  ///< no force
  /// The forces of the same contacts when fewer vertices could move.
  void take_over(const AugmentedContacts& before) {
    if (contacts_) contacts_->take_over(*before.contacts_);
  }
  void begin(double t, double h);
  /// elastic: of all links and bending at each vertex [N/m].
  void set_stiffness(const Particles<double>& p, std::span<const double> elastic, double h);
  /// What touches at p.x.
  void find(const Particles<double>& p) {
    if (contacts_) contacts_->find(p, touching_);
  }
  bool touch() const { return !touching_.empty(); }
  void let_go() { touching_.clear(); }  ///< nothing touches until find()

  // Of what touches, at x:
  void add_energy(const std::vector<Vec3>& x, double& sum) const;                  ///< J
  void add_gradient(const std::vector<Vec3>& x, const Hessian&, Vector& g) const;  ///< N
  void add_hessian(const std::vector<Vec3>& x, Hessian&) const;                    ///< N/m

  /// The forces become what acts at p.x, if the gradient that is left [N] is less; what has newly
  /// come inside is held from now on, at first by what its own inertia asks for. Whether a force
  /// changes by more than `rounding` [N]. False without contact.
  bool update(const Particles<double>& p, double h, double left, double rounding);

 private:
  /// A contact's part at x: energy [J], force [N], Hessian [N/m].
  struct Part {
    double energy = 0;
    Vec3 force = Vec3::Zero();
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  };
  Part part(const TouchingVertex& at, const Vec3& x) const;

  std::unique_ptr<Contacts> contacts_;    ///< null: none
  std::vector<TouchingVertex> touching_;  ///< of this iteration
  std::vector<ContactForce> acting_;      ///< [touching]
  std::vector<double> stiffness_;         ///< [n] N/m, k; empty: no contact
};

}  // namespace taut::solver::implicit
