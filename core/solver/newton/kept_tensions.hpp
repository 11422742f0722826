#pragma once

#include <algorithm>
#include <vector>

#include "core/model/params.hpp"
#include "core/solver/newton/hessian.hpp"

namespace taut::solver::implicit {

/// A tension f [N] of each spring that is kept from step to step. Starting from x = y, an iteration
/// is
///
///     H = M/h^2 + sum K u u^T + max(0, f)/|d| (I - u u^T),   f <- K (C + u.(p_b - p_a)),
///     x <- x + p
///
/// The K C of an iterate is K times its length error, which for large K locks the motion across
/// links. f, which comes from the solution of the linear system, does not.
class KeptTensions {
 public:
  static constexpr ParamSpec kParam =
      ParamSpec::choice("multipliers", "off", "off|keep",
                        "keep each link's tension, and with it the link's resistance to sideways "
                        "motion, from step to step: three iterations from the prediction are then "
                        "enough, without a line search. A step that goes astray, and one in which "
                        "the cloth touches a collider, is computed by Newton's method as usual");

  /// The springs must outlive it.
  KeptTensions(const Params& params, const std::vector<Spring>& springs)
      : springs_(springs), tension_(params.is("multipliers", "keep") ? springs.size() : 0) {}

  bool on() const { return !tension_.empty(); }
  void forget() { std::ranges::fill(tension_, 0); }
  /// Takes over the tensions of the same springs when fewer vertices could move; springs keep their
  /// order.
  void take_over(const KeptTensions& before);
  /// Sets the springs' part of H at x.
  void put_into(Hessian&, const std::vector<Vec3>& x);
  /// Updates the tensions by the solution for that H [m].
  void follow(const Vector& direction, Hessian&);

 private:
  const std::vector<Spring>& springs_;
  std::vector<double> tension_;  ///< N; empty: off
  std::vector<double> excess_;   ///< m, C at x
};

}  // namespace taut::solver::implicit
