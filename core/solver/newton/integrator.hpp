#pragma once

#include <vector>

#include "core/model/params.hpp"
#include "core/solver/layout/particles.hpp"

namespace taut::solver::implicit {

/// Steps of the same form as implicit Euler's, the minimum of sum m/(2 h'^2) |x - y|^2 plus the
/// elastic energy, but with another y and h':
///
///     BDF2      h' = 2h/3,  y = (4 x_t - x_t-1)/3 + h' (4 v_t - v_t-1)/3 + h'^2 g,
///               v = (x - (4 x_t - x_t-1)/3)/h'; the first step is implicit Euler's
///     midpoint  h' = h/2,   y = x_t + h' v_t + h'^2 g;   x <- 2x - x_t,  v = 2 (x - x_t)/h - v_t
///
/// Contact, wind and damping are excluded: they would act at another time than the links.
class Integrator {
 public:
  static constexpr ParamSpec kParam =
      ParamSpec::choice("integrator", "euler", "euler|bdf2|midpoint",
                        "implicit Euler, or BDF2 or the implicit midpoint rule, which lose less "
                        "energy but run only without wind, damping and contact");

  Integrator(const Params&, const Vec3& gravity);  ///< gravity in m/s^2
  void forget() { before_.clear(); }               ///< the next step has no predecessor
  double own_step(double h) const;                 ///< h' for a step of h [s]
  /// Replaces implicit Euler's y by the integrator's, and moves pins to where they are after h'.
  void predict(Particles<double>& p, Points<double>& y, double h);
  /// Sets positions and velocities at the end of the step; the loop takes velocities from
  /// p.previous.
  void finish(Particles<double>& p, double h);

 private:
  enum class Kind { euler, bdf2, midpoint } kind_;
  Vec3 gravity_;
  std::vector<Vec3> before_, v_before_;  ///< m, m/s, a step ago, for BDF2; empty: no step yet
  std::vector<Vec3> start_, v_start_;    ///< m, m/s, at the start of this step
  std::vector<Vec3> pins_at_end_;        ///< [n] m
};

}  // namespace taut::solver::implicit
