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

/// Contacts of vertices that a linear system couples: a force at one moves all.
///
///     x_i = free_i + sum_j G_ij f_j,      G [m/N] the same for x, y and z (the Delassus operator)
///
/// Each round of a semi-smooth Newton method takes every contact as open, sticking or sliding,
/// whichever its force would be if it alone had to close its gap and slip, and solves the linear
/// system that this leaves (Alart, Curnier 1991, where a contact's own compliance is the
/// parameter). Sweeps contact by contact end it (projected Gauss-Seidel; Jean, Moreau 1992): forces
/// are within their cones whatever the rounds left.
class CoupledContacts {
 public:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3>;

  void begin() { factored_in_substep_ = 0; }        ///< a substep
  void compliance_changed() { factored_.reset(); }  ///< it is another matrix from now on

  /// Of the contacts `at`, contact c of vertex `place[c]` of G, with the force force(c). Changes
  /// the forces and moves x [places] m; returns the sums of the changes [places] N.
  Rows resolve(const Eigen::MatrixXd& compliance, std::span<const TouchingVertex> at,
               std::span<const Eigen::Index> place,
               const std::function<ContactForce&(std::size_t)>& force, Rows& x);

 private:
  enum class State { open, sticking, sliding };
  struct Trial {
    State state = State::open;
    Vec3 direction = Vec3::Zero();  ///< of a sliding one's force: normal + mu across
    double away = 0;                ///< m, from the conditions of contact
  };
  Trial trial(std::size_t contact, const Rows& x) const;
  /// The places of those that stick and slide, and what their matrices rest on.
  struct Sets {
    std::vector<Eigen::Index> sticking, sliding;
    std::vector<Vec3> normals, directions;  ///< of those that slide
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
