#pragma once

#include <memory>
#include <span>

#include "core/model/membrane.hpp"
#include "core/solver/layout/particles.hpp"

namespace taut {

/// Projects the scene's membrane, one triangle after another in the order of colours. Each is ONE
/// constraint of three rows, its strain c (MembraneLaw::strain), with the compliance C^-1 over its
/// area (XPBD, as in core/solver/xpbd.cpp):
///
///     (sum w_a J_a J_a^T + a) dlambda = -(c + a lambda),   x_a += w_a J_a^T dlambda,
///     a = C^-1/(A h^2),   J_a = d c/d x_a
///
/// lambda is 0 at the start of a substep and kept from sweep to sweep, so converged sweeps give
/// implicit Euler's step up to O(h^2) of the change of J. Three scalar constraints with a diagonal
/// compliance have no Poisson's effect at all, and one C = sqrt(2 energy) has another material.
/// Computed in double on the differences of positions.
/// Damping is another C and another strain at rest in each substep (MembraneLaw).
/// w: inverse masses [1/kg]; h: length of the substeps [s].
template <class Real>
std::unique_ptr<Pass<Real>> make_membrane_pass(const Scene&, std::span<const double> w, double h);

}  // namespace taut
