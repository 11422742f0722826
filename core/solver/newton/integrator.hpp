#pragma once

#include <vector>

#include "core/model/params.hpp"
#include "core/solver/layout/particles.hpp"

namespace taut::solver::implicit {

/// Steps of the same form as implicit Euler's, the minimum of sum m/(2 h'^2) |x - y|^2 and the
/// elastic energy, with another y and h':
///
///     BDF2      h' = 2h/3,  y = (4 x_t - x_t-1)/3 + h' (4 v_t - v_t-1)/3 + h'^2 g,
///               v = (x - (4 x_t - x_t-1)/3)/h'; the first step is implicit Euler's
///     midpoint  h' = h/2,   y = x_t + h' v_t + h'^2 g;   x <- 2x - x_t,  v = 2 (x - x_t)/h - v_t
///
/// Contact, wind and damping would act at another time than the links.
class Integrator {
 public:
  static constexpr ParamSpec kParam =
      ParamSpec::choice("integrator", "euler", "euler|bdf2|midpoint",
                        "implicit Euler, or BDF2 or the implicit midpoint rule, which lose less "
                        "energy but run only without wind, damping and contact");

  Integrator(const Params&, const Vec3& gravity);  ///< m/s^2
  void forget() { before_.clear(); }               ///< no step was before the next
  double own_step(double h) const;                 ///< h' of a step of h [s]
  /// y, which is implicit Euler's, becomes the integrator's, and pins go where its h' ends.
  void predict(Particles<double>& p, Points<double>& y, double h);
  /// Places and velocities at the end of the step; the loop takes a velocity from p.previous.
  void finish(Particles<double>& p, double h);

 private:
  enum class Kind { euler, bdf2, midpoint } kind_;
  Vec3 gravity_;
  std::vector<Vec3> before_, v_before_;  ///< m, m/s, a step ago, of BDF2; empty: there was none
  std::vector<Vec3> start_, v_start_;    ///< m, m/s, of this step
  std::vector<Vec3> pins_at_end_;        ///< [n] m
};

}  // namespace taut::solver::implicit
