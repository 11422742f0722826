#pragma once

#include <algorithm>
#include <vector>

#include "core/model/params.hpp"
#include "core/solver/newton/hessian.hpp"

namespace taut::solver::implicit {

/// A tension f [N] of each spring that outlives the step. From x = y on,
///
///     H = M/h^2 + sum K u u^T + max(0, f)/|d| (I - u u^T),   f <- K (C + u.(p_b - p_a)),
///     x <- x + p
///
/// for K C of an iterate is K times its error, which where K is large locks the motion across
/// links, and f, of the linear system's solution, is not.
class KeptTensions {
 public:
  static constexpr ParamSpec kParam =
      ParamSpec::choice("multipliers", "off", "off|keep",
                        "keep each link's tension, and with it the link's resistance to sideways "
                        "motion, from step to step: three iterations from the prediction are then "
                        "enough, without a line search. A step that goes astray, and one in which "
                        "the cloth touches a collider, is computed by Newton's method as usual");

  /// Of springs that outlive them.
  KeptTensions(const Params& params, const std::vector<Spring>& springs)
      : springs_(springs), tension_(params.is("multipliers", "keep") ? springs.size() : 0) {}

  bool on() const { return !tension_.empty(); }
  void forget() { std::ranges::fill(tension_, 0); }
  /// Those of the same springs when fewer could move: springs keep their order.
  void take_over(const KeptTensions& before);
  /// The springs' part of H at x.
  void put_into(Hessian&, const std::vector<Vec3>& x);
  /// By the solution for that H [m].
  void follow(const Vector& direction, Hessian&);

 private:
  const std::vector<Spring>& springs_;
  std::vector<double> tension_;  ///< N; empty: off
  std::vector<double> excess_;   ///< m, C at x
};

}  // namespace taut::solver::implicit
