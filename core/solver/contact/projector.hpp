#pragma once

#include <memory>

#include "core/model/collider.hpp"
#include "core/solver/simd/kernels.hpp"

namespace taut {

/// Puts out of a collider what is inside, step after step. Particles are taken as they lie in
/// memory, some at once.
template <class Real>
class Projector {
 public:
  virtual ~Projector() = default;
  /// What follows belongs to the step [t, t + dt].
  virtual void begin(double t, double dt) = 0;
  virtual void project(const CollideSpan<Real>&) const = 0;
};

/// Keeps particles at `thickness` [m]; `swept` also catches those that passed through the collider
/// since the step began.
template <class Real>
std::unique_ptr<Projector<Real>> make_projector(const Collider&, double thickness, bool swept,
                                                Simd);

}  // namespace taut
