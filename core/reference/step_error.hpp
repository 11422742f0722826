#pragma once

#include <memory>
#include <vector>

#include "core/model/declared_step.hpp"
#include "core/model/scene.hpp"

namespace taut::reference {

/// How far an answer is from the exact step of implicit Euler, without that step: the way that
/// Newton's method goes from the answer towards the minimum of
///
///     y = x_t + h exp(-damping h) v_t + h^2 (g + wind),
///     G(x) = sum m/(2 h^2) |x - y|^2 + sum K/2 C^2 + bending
///
/// in two steps, for the second says whether the first is to be believed, and in up to four where
/// it is not small; steps that shrink by a factor are summed to their end. A link's tension in the
/// Hessian is not that of the answer, which is K times its error, but the one to which the same
/// linear system leads: so stiff links do not lock what is across them, and rigid ones (a KKT step,
/// by multipliers) are no other case. Links that are pushed resist no bending. What touches a
/// collider is an active set: at the scene's thickness while it pushes, stuck while friction holds
/// it, else rubbed by mu times the push. Self-collision is left out.
class StepError {
 public:
  StepError(const Scene&, const Stiffness&);  ///< of a scene that outlives it
  ~StepError();

  struct Estimate {
    double distance = 0;  ///< m, RMS over the vertices that move
    double last = 0;      ///< m, RMS of the last of Newton's steps
    /// Not of a sheet that is about to buckle, nor where what touches is not settled.
    bool believed = false;
  };
  /// Of x, the answer to a step of h [s] from `from` at time t [s]. NaN: there is no factor, or x
  /// is not finite.
  Estimate of(const State& from, double t, double h, const std::vector<Vec3>& x);
  /// The way [n] that the exact step goes beyond x with the lengths which the links have in x: what
  /// the answer misses of the motion, however much it strains. Empty: it does not come to rest.
  std::vector<Vec3> missed(const State& from, double t, double h, const std::vector<Vec3>& x);

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace taut::reference
