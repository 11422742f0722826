#pragma once

#include "core/model/solver.hpp"
#include "core/solver/particles.hpp"

namespace taut {

/// One effect of a scene with the data it needs. It exists only if the scene has the effect: no
/// flag is tested inside the loop, and an absent effect owns no memory.
template <class Real>
class Pass {
 public:
  virtual ~Pass() = default;
  /// The solver starts anew from another state: forget what was.
  virtual void restart() {}
  /// Once for the step [t, t + dt], after integration and before the first sweep.
  virtual void begin(Particles<Real>&, double /*t*/, double /*dt*/) {}
  /// For the step [t, t + dt].
  virtual void apply(Particles<Real>&, double t, double dt) = 0;
  /// Of one application, a line for each thing it does; the solver sets `repeats`.
  virtual std::vector<PassCost> cost() const = 0;
};

}  // namespace taut
