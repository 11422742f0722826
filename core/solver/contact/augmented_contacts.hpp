#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/triangle.hpp"
#include "core/solver/contact/contacts.hpp"

namespace taut {

struct TouchingPiece;

/// Finds the pieces that touch a collider.
class PieceFinder {
 public:
  virtual ~PieceFinder() = default;
  /// Lays the contact anew where the piece is nearest to the collider with its corners at x, if the
  /// collider is round.
  virtual void lay(TouchingPiece&, const Corners& x) const = 0;
};

/// A point of a face or an edge of the cloth that touches a collider, and its last contact force.
struct TouchingPiece {
  const PieceFinder* found_by = nullptr;
  std::size_t number = 0;  ///< number of the piece at its finder
  Triangle corners;
  Vec3 weights = Vec3::Zero();  ///< of the corners; their sum is 1
  TouchingVertex at;
  ContactForce force;
  /// Derivative of the normal by the point [1/m]; 0: the contact is not laid anew.
  Eigen::Matrix3d turning = Eigen::Matrix3d::Zero();

  /// The point's position. x: positions by vertex [m].
  template <class Places>
  Vec3 place(const Places& x) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t c = 0; c < 3; ++c)
      sum += weights[static_cast<Eigen::Index>(c)] *
             Vec3(x[to_index(corners[c])].template cast<double>());
    return sum;
  }
};

/// Least lever at which contact turns an edge about a pinned corner, as a share of its length.
inline constexpr double kLever = 0.02;

/// The touching pieces of all colliders, which FaceContactPass finds after each iteration for the
/// next.
struct TouchingPieces {
  std::vector<TouchingPiece> all;
  /// Whether the solver itself solves for the forces; otherwise they are updated after each
  /// iteration.
  bool solved = false;
  std::span<const double> stiffness;  ///< [n] N/m, stiffness of contact at each vertex
  double left = 0, rounding = 0;      ///< N, as in AugmentedContacts::update()
  bool changed = false;               ///< a force has changed by more than `rounding`

  /// Stiffness at the point. Where a corner is pinned, it is as much larger as the lever is small.
  double stiffness_of(const TouchingPiece& piece) const {
    double k = 0, moving = piece.turning.isZero(0) ? 1 : 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double weight = piece.weights[static_cast<Eigen::Index>(c)];
      const double at = stiffness[to_index(piece.corners[c])];
      k += weight * at;
      if (at > 0) moving = std::min(moving + weight, 1.0);
    }
    return k / std::pow(std::max(moving, kLever), 3);
  }
};

/// Stiffness of contact at a vertex, as a multiple of all other stiffness there.
inline constexpr double kOfElsewhere = 3;

/// Largest gradient at which the contact forces are updated, as a share of their change.
inline constexpr double kSettled = 0.3;

/// The forces push' and rub' (see AugmentedContacts) at x.
inline ContactForce augmented(const TouchingVertex& at, const ContactForce& held, double k,
                              const Vec3& x) {
  ContactForce now{std::max(0.0, held.push - k * at.gap(x)), held.rub - k * at.slip(x)};
  now.rub *= at.cone(now.rub, now.push).share();
  return now;
}

/// The share of their change by which contact forces are updated. Friction depends on the push, and
/// the push on friction; where that swings, smaller updates settle.
class Pace {
 public:
  /// change: of all forces in this update [N].
  double share(double change) {
    if (change < kProgress * least_) {
      least_ = change;
      without_ = 0;
    } else if (++without_ >= kPatience) {
      share_ = std::max(share_ / 2, kLeast);
      without_ = 0;
      least_ = change;
    }
    return share_;
  }

 private:
  static constexpr double kProgress = 0.9, kLeast = 1.0 / 32;
  static constexpr int kPatience = 8;
  double share_ = 1, least_ = std::numeric_limits<double>::infinity();
  int without_ = 0;  ///< updates without progress
};

/// Contact as an augmented Lagrangian at each touching vertex (Alart, Curnier, Computer Methods in
/// Applied Mechanics and Engineering 92, 1991). With the force of the last iteration, push along
/// the normal n and rub across it, and a stiffness k, the acting forces are
///
///     push' = max(0, push - k gap),   rub' = rub - k slip, no longer than mu push
///
/// Where they hold and stick, k n n^T + k (I - n n^T) is added to the Hessian. The acting forces
/// become the forces once the gradient that is left is less than a share of their change (Pace). If
/// this happened sooner, contacts would take turns at sticking and slipping for ever.
///
/// The gap is the distance from the surface, wherever x is: a half-space that is laid once an
/// iteration knows no edge, and a vertex that slides round one would go from side to side. The
/// Hessian includes the turning of n unless that makes it indefinite. Friction acts across the
/// normal of the last iterate, since with a normal that turns it would have no energy. A contact
/// that was found once is followed until the substep ends. It stays on the side where the last
/// iterate had it, and not on the side of a straight path from x_t, which cuts the corner.
///
/// A point of a face or an edge may also touch; its corners share everything by its weights.
class AugmentedContacts {
 public:
  AugmentedContacts() = default;  ///< no contact
  AugmentedContacts(const Scene& scene, const Params& params)
      : contacts_(make_contacts(scene, params)), stiffness_(contacts_ ? scene.start.x.size() : 0) {}

  void forget();  ///< sets all forces to 0
  /// Takes over the forces of the same contacts when fewer vertices could move.
  void take_over(const AugmentedContacts& before) {
    if (contacts_) contacts_->take_over(*before.contacts_);
  }
  void begin(double t, double h);
  /// elastic: stiffness of all links and bending at each vertex [N/m].
  template <class Real>
  void set_stiffness(const Particles<Real>& p, std::span<const double> elastic, double h);
  /// Sets the forces of new contacts at p.x = y, as if their vertices had no links.
  template <class Real>
  void predict_new(const Particles<Real>& p, double h) {
    if (contacts_) contacts_->predict_new(p, h);
  }
  /// Finds the vertices that touch at p.x.
  template <class Real>
  void find(const Particles<Real>& p) {
    if (contacts_) contacts_->find(p, touching_, &met_);
  }
  bool any() const { return contacts_ != nullptr; }  ///< the scene has something to touch
  bool touch() const { return !touching_.empty() || !pieces_.all.empty(); }
  void let_go() { touching_.clear(); }  ///< no vertex touches until find()
  TouchingPieces& pieces() { return pieces_; }

  /// A contact's terms at x: energy [J], force [N], Hessian [N/m].
  struct Part {
    double energy = 0;
    Vec3 force = Vec3::Zero();
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  };
  /// Calls visit(vertex, part) for the vertices that touch, at x. The contacts of a vertex follow
  /// one another.
  template <class Visit>
  void each(const std::vector<Vec3>& x, const Visit& visit) const {
    for (const TouchingVertex& at : touching_)
      visit(at.vertex, part(laid(at, x[at.vertex]), at, contacts_->force(at.vertex, at.collider),
                            stiffness_[at.vertex], x[at.vertex]));
  }
  /// Calls visit(vertex, K): with K [N/m] added to each contact's Hessian, the turning of its
  /// normal is in it, too. K is negative: a vertex that is pushed onto an edge tends to slide off.
  template <class Visit>
  void each_turning(const std::vector<Vec3>& x, const Visit& visit) const {
    for (const TouchingVertex& at : touching_) {
      const double push = contacts_->force(at.vertex, at.collider).push -
                          stiffness_[at.vertex] * laid(at, x[at.vertex]).gap(x[at.vertex]);
      if (at.nearest && push > 0)
        visit(at.vertex, Eigen::Matrix3d(-push * turning(at, x[at.vertex])));
    }
  }
  /// Calls visit(piece, part) for the faces and edges that touch, at x.
  template <class Visit>
  void each_piece(const std::vector<Vec3>& x, const Visit& visit) const {
    for (const TouchingPiece& piece : pieces_.all) {
      const double k = pieces_.stiffness_of(piece);
      TouchingPiece laid = piece;
      Corners at;
      for (std::size_t c = 0; c < 3; ++c) at[c] = x[to_index(piece.corners[c])];
      piece.found_by->lay(laid, at);
      visit(laid, push_of(laid.at, piece.force, k, laid.place(x)));
      if (piece.at.friction > 0) {
        TouchingPiece rubbed = piece;
        rubbed.turning.setZero();
        visit(rubbed, rub_of(piece.at, piece.force, k, piece.place(x)));
      }
    }
  }

  /// Sets the forces to those acting at x if the gradient `left` [N] is small enough; x equals p.x
  /// up to rounding. A new contact is held from now on, at first by the force that its own inertia
  /// needs. Returns whether a force changes by more than `rounding` [N]; false without contact.
  template <class Real>
  bool update(const Particles<Real>& p, const std::vector<Vec3>& x, double h, double left,
              double rounding);

  /// Ends a substep: moves vertices that are still inside out of the colliders, on the side where
  /// the iterations had them, with friction for the way out.
  template <class Real>
  void leave(Particles<Real>& p);

  /// across: where friction acts across the normal.
  static Part part(const TouchingVertex& at, const TouchingVertex& across, const ContactForce& held,
                   double k, const Vec3& x) {
    const Part push = push_of(at, held, k, x), rub = rub_of(across, held, k, x);
    return {push.energy + rub.energy, push.force + rub.force, push.hessian + rub.hessian};
  }
  static Part push_of(const TouchingVertex&, const ContactForce& held, double k, const Vec3& x);
  static Part rub_of(const TouchingVertex&, const ContactForce& held, double k, const Vec3& x);

 private:
  TouchingVertex laid(TouchingVertex at, const Vec3& x) const {
    contacts_->lay(at, x);
    return at;
  }
  /// Derivative of the normal by x [1/m].
  Eigen::Matrix3d turning(const TouchingVertex& at, const Vec3& x) const;

  std::unique_ptr<Contacts> contacts_;    ///< null: no contact
  std::vector<MetInSubstep> met_;         ///< in this substep
  std::vector<TouchingVertex> touching_;  ///< of this iteration
  std::vector<ContactForce> acting_;      ///< [touching]
  Pace pace_;                             ///< in this substep
  std::vector<double> stiffness_;         ///< [n] N/m, k; empty: no contact
  TouchingPieces pieces_;
};

}  // namespace taut
