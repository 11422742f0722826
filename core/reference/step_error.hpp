#pragma once

#include <memory>
#include <vector>

#include "core/model/declared_step.hpp"
#include "core/model/scene.hpp"

namespace taut::reference {

/// Estimates how far an answer is from the exact step of implicit Euler, without computing that
/// step: by how far Newton's method moves from the answer towards the minimum of
///
///     y = x_t + h exp(-damping h) v_t + h^2 (g + wind),
///     G(x) = sum m/(2 h^2) |x - y|^2 + sum K/2 C^2 + bending + membrane
///
/// with the K and rest lengths that damped links have in that step (core/model/link_damping.hpp).
/// It takes two steps, since the second one shows whether to believe the first, and up to four
/// where the second is not small; steps that shrink by a factor are summed to their limit. A link's
/// tension in the Hessian is not that of the answer, which is K times its error, but the one that
/// follows from the same linear system. Stiff links thus do not lock the motion across them, and
/// rigid links (a KKT step, by multipliers) are no special case. Compressed links resist no
/// bending. Contact is an active set: a vertex is at the scene's thickness while it pushes, and
/// sticks while friction holds it; otherwise friction is mu times the push. Self-collision is left
/// out.
class StepError {
 public:
  StepError(const Scene&, const Stiffness&);  ///< the scene must outlive it
  ~StepError();

  struct Estimate {
    double distance = 0;  ///< m, RMS over the vertices that move
    double last = 0;      ///< m, RMS of the last of Newton's steps
    /// False for a sheet that is about to buckle, and where contact is not settled.
    bool believed = false;
  };
  /// Estimate for x, the answer to a step of h [s] from `from` at time t [s]. NaN if there is no
  /// factor or x is not finite.
  Estimate of(const State& from, double t, double h, const std::vector<Vec3>& x);

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace taut::reference
