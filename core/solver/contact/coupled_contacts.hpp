#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/solver/contact/contacts.hpp"

namespace taut {

/// Contacts of vertices that a linear system couples: a force at one vertex moves all.
///
///     x_i = free_i + sum_j G_ij f_j,      G [m/N] the same for x, y and z (the Delassus operator)
///
/// Each round of a semi-smooth Newton method takes every contact as open, sticking or sliding. The
/// force with which a contact alone would close its gap and slip decides which. The round then
/// solves the linear system that remains (Alart, Curnier 1991, where a contact's own compliance is
/// the parameter). If the rounds do not converge, sweeps from contact to contact follow (projected
/// Gauss-Seidel; Jean, Moreau 1992), so that forces are within their friction cones.
class CoupledContacts {
 public:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3>;

  /// Begins a substep.
  void begin() { factored_in_substep_ = 0; }
  /// To be called when the compliance matrix has changed.
  void compliance_changed() { factored_.reset(); }

  /// Resolves the contacts `at`; contact c is at vertex `place[c]` of G and has the force force(c).
  /// Changes the forces and moves x [places] m. Returns the change of the force at each place
  /// [places] N.
  Rows resolve(const Eigen::MatrixXd& compliance, std::span<const TouchingVertex> at,
               std::span<const Eigen::Index> place,
               const std::function<ContactForce&(std::size_t)>& force, Rows& x);

 private:
  enum class State { open, sticking, sliding };
  struct Trial {
    State state = State::open;
    Vec3 direction = Vec3::Zero();  ///< of the force of a sliding contact: normal + mu across
    double away = 0;                ///< m, distance from the conditions of contact
  };
  Trial trial(std::size_t contact, const Rows& x) const;
  /// The places of sticking and sliding contacts, and what their matrices depend on.
  struct Sets {
    std::vector<Eigen::Index> sticking, sliding;
    std::vector<Vec3> normals, directions;  ///< of sliding contacts
    bool operator==(const Sets&) const = default;
  };
  Sets sets_of(const std::vector<Trial>&) const;
  void factor(const Sets&);
  void solve(const std::vector<Trial>&, Rows& x, Rows& change);
  void sweep(Rows& x, Rows& change);

  struct Factored {
    Sets sets;
    Eigen::LLT<Eigen::MatrixXd> sticking;  ///< G_SS
    Eigen::MatrixXd across;                ///< G_SS^-1 G_SL
    Eigen::PartialPivLU<Eigen::MatrixXd> sliding;
  };
  std::optional<Factored> factored_;
  int factored_in_substep_ = 0;
  const Eigen::MatrixXd* compliance_ = nullptr;
  std::span<const TouchingVertex> at_;
  std::span<const Eigen::Index> place_;
  const std::function<ContactForce&(std::size_t)>* force_ = nullptr;
};

}  // namespace taut
