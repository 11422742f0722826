#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "core/solver/contact/contacts.hpp"

namespace taut {

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
  AugmentedContacts() = default;  ///< none
  AugmentedContacts(const Scene& scene, const Params& params)
      : contacts_(make_contacts(scene, params)), stiffness_(contacts_ ? scene.start.x.size() : 0) {}

  void forget();  ///< no force
  /// The forces of the same contacts when fewer vertices could move.
  void take_over(const AugmentedContacts& before) {
    if (contacts_) contacts_->take_over(*before.contacts_);
  }
  void begin(double t, double h);
  /// elastic: of all links and bending at each vertex [N/m].
  template <class Real>
  void set_stiffness(const Particles<Real>& p, std::span<const double> elastic, double h);
  /// The forces of what newly touches at p.x = y as if it had no link.
  template <class Real>
  void predict_new(const Particles<Real>& p, double h) {
    if (contacts_) contacts_->predict_new(p, h);
  }
  /// What touches at p.x.
  template <class Real>
  void find(const Particles<Real>& p) {
    if (contacts_) contacts_->find(p, touching_);
  }
  bool any() const { return contacts_ != nullptr; }  ///< the scene has what may touch
  bool touch() const { return !touching_.empty(); }
  void let_go() { touching_.clear(); }  ///< nothing touches until find()

  /// A contact's part at x: energy [J], force [N], Hessian [N/m].
  struct Part {
    double energy = 0;
    Vec3 force = Vec3::Zero();
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  };
  /// visit(vertex, part) of what touches, at x. A vertex' contacts come one after the other.
  template <class Visit>
  void each(const std::vector<Vec3>& x, const Visit& visit) const {
    for (const TouchingVertex& at : touching_) visit(at.vertex, part(at, x[at.vertex]));
  }

  /// The forces become what acts at x, which p.x is but for rounding, if the gradient that is left
  /// [N] is less; what has newly come inside is held from now on, at first by what its own inertia
  /// asks for. Whether a force changes by more than `rounding` [N]. False without contact.
  template <class Real>
  bool update(const Particles<Real>& p, const std::vector<Vec3>& x, double h, double left,
              double rounding);

 private:
  Part part(const TouchingVertex& at, const Vec3& x) const;

  std::unique_ptr<Contacts> contacts_;    ///< null: none
  std::vector<TouchingVertex> touching_;  ///< of this iteration
  std::vector<ContactForce> acting_;      ///< [touching]
  std::vector<double> stiffness_;         ///< [n] N/m, k; empty: no contact
};

}  // namespace taut
