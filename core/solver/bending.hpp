#pragma once

#include <memory>
#include <span>

#include "core/model/bending.hpp"
#include "core/solver/layout/particles.hpp"

namespace taut {

/// Projects the scene's bending elements one after another. Each is a constraint
/// g = sum c_i x_i = 0 of three components with compliance 1/k (XPBD, as in core/solver/xpbd.cpp):
///
///     dlambda = (-g - a lambda)/(sum w_i c_i^2 + a),   x_i += w_i c_i dlambda,   a = 1/(k h^2)
///
/// g is linear, so a projection is exact. lambda is 0 at the start of a substep and kept from sweep
/// to sweep, so converged sweeps give implicit Euler's step. w: inverse masses [1/kg].
template <class Real>
std::unique_ptr<Pass<Real>> make_bending_pass(const Scene&, std::span<const double> w);

}  // namespace taut
