#pragma once

#include <optional>
#include <string>

#include "core/model/scene.hpp"
#include "core/model/solver.hpp"

namespace taut {

/// What linear theory says of a solver on a scene: small displacements about the start, links at
/// their rest length, no gravity, wind or contact.
struct LinearStability {
  double margin = 0;  ///< stable while at most 1: see `law`
  double growth = 0;  ///< of the fastest mode, per step (of a substep); 0: not known
  std::string law;    ///< the condition, for people
  bool stable() const { return margin <= 1 + 1e-6; }
};

/// Empty where no theory is known, for the solver says what it does (SolverEntry::linear_model), or
/// where its eigenvalues cannot be computed.
///
/// LinearSprings, Verlet and symplectic Euler. With the stiffness K of springs and bending, masses
/// M, drag C, h the substep, q = exp(-damping h), a mode turns unstable when its multiplier reaches
/// -1:
///     lagged drag    h^2 K + 2 h C          against 2 (1 + q) M
///     central drag   h^2 K - (1 - q) h C    against 2 (1 + q) M
/// For one mass: h < (2/w)(sqrt(1 + zeta^2) - zeta), and 2/w without drag. `margin` is the largest
/// eigenvalue of M^-1/2 (left) M^-1/2 over 2 (1 + q), by Lanczos. Explicit Euler without drag or
/// damping grows by sqrt(1 + h^2 w^2) at every h; with drag and equal masses it is stable while
/// h < C/(M w^2), and h < 2 M/C.
///
/// LinearSweeps, at most 128 links. k sweeps G take the predicted strains to
/// e' = G^k ((1 + q) e - q e''), so an eigenvalue mu of G^k gives the multipliers
/// z^2 - (1 + q) mu z + q mu = 0. `margin` and `growth` are the largest |z|. It does not depend on
/// dt. One link, one sweep: stable up to the relaxation factor 4/3.
std::optional<LinearStability> linear_stability(const Scene&, const SolverChoice&);

}  // namespace taut
