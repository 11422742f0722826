#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "core/model/index.hpp"
#include "core/solver/contact/contacts.hpp"

namespace taut {

/// A point of a face or an edge of the cloth at a collider, and the force that has held it.
struct TouchingPiece {
  const void* found_by = nullptr;
  std::size_t number = 0;  ///< of the piece, by its finder
  Triangle corners;
  Vec3 weights = Vec3::Zero();  ///< of the corners, sum 1
  TouchingVertex at;
  ContactForce force;

  /// x: places by vertex [m].
  template <class Places>
  Vec3 place(const Places& x) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c)
      sum += weights[static_cast<Eigen::Index>(c)] *
             Vec3(x[to_index(corners[c])].template cast<double>());
    return sum;
  }
};

/// Those of all colliders, which FaceContactPass finds after each iteration for the next one.
struct TouchingPieces {
  std::vector<TouchingPiece> all;
  /// The solver leaves the forces as contact asks for; else they follow after each iteration.
  bool solved = false;
  std::span<const double> stiffness;  ///< [n] N/m, of contact at each vertex
  double left = 0, rounding = 0;      ///< N, as in AugmentedContacts::update()
  bool changed = false;               ///< a force has, by more than that

  double stiffness_of(const TouchingPiece& piece) const {
    double k = 0;
    for (std::size_t c = 0; c < 3; ++c)
      k += piece.weights[static_cast<Eigen::Index>(c)] * stiffness[to_index(piece.corners[c])];
    return k;
  }
};

/// Of the stiffness of all else at a vertex, that of its contact.
inline constexpr double kOfElsewhere = 3;

/// Of a change of the forces of contact, the gradient that is left before they take it.
inline constexpr double kSettled = 0.3;

/// push' and rub' below at x.
inline ContactForce augmented(const TouchingVertex& at, const ContactForce& held, double k,
                              const Vec3& x) {
  ContactForce now{std::max(0.0, held.push - k * at.gap(x)), held.rub - k * at.slip(x)};
  now.rub *= at.cone(now.rub, now.push).share();
  return now;
}

/// Contact as an augmented Lagrangian at each vertex that touches (Alart, Curnier, Computer Methods
/// in Applied Mechanics and Engineering 92, 1991): with the force of the last iteration, push along
/// the normal n and rub across it, and a stiffness k,
///
///     push' = max(0, push - k gap),   rub' = rub - k slip, no longer than mu push
///
/// act, k n n^T + k (I - n n^T) join the Hessian where they hold and stick. They become the forces
/// once the gradient that is left is less than a share of their change: sooner, and contacts would
/// take turns at sticking and slipping without end.
///
/// What touches may be a point of a face or an edge, as well: its corners share all by its weights.
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
  bool touch() const { return !touching_.empty() || !pieces_.all.empty(); }
  void let_go() { touching_.clear(); }  ///< no vertex touches until find()
  TouchingPieces& pieces() { return pieces_; }

  /// A contact's part at x: energy [J], force [N], Hessian [N/m].
  struct Part {
    double energy = 0;
    Vec3 force = Vec3::Zero();
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  };
  /// visit(vertex, part) of what touches, at x. A vertex' contacts come one after the other.
  template <class Visit>
  void each(const std::vector<Vec3>& x, const Visit& visit) const {
    for (const TouchingVertex& at : touching_)
      visit(at.vertex, part(at, contacts_->force(at.vertex, at.collider), stiffness_[at.vertex],
                            x[at.vertex]));
  }
  /// visit(piece, part) of faces and edges.
  template <class Visit>
  void each_piece(const std::vector<Vec3>& x, const Visit& visit) const {
    for (const TouchingPiece& piece : pieces_.all)
      visit(piece, part(piece.at, piece.force, pieces_.stiffness_of(piece), piece.place(x)));
  }

  /// The forces become what acts at x, which p.x is but for rounding, if the gradient that is left
  /// [N] is less; what has newly come inside is held from now on, at first by what its own inertia
  /// asks for. Whether a force changes by more than `rounding` [N]. False without contact.
  template <class Real>
  bool update(const Particles<Real>& p, const std::vector<Vec3>& x, double h, double left,
              double rounding);

  static Part part(const TouchingVertex& at, const ContactForce& held, double k, const Vec3& x);

 private:
  std::unique_ptr<Contacts> contacts_;    ///< null: none
  std::vector<TouchingVertex> touching_;  ///< of this iteration
  std::vector<ContactForce> acting_;      ///< [touching]
  std::vector<double> stiffness_;         ///< [n] N/m, k; empty: no contact
  TouchingPieces pieces_;
};

}  // namespace taut
