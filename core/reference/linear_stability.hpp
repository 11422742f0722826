#pragma once

#include <optional>
#include <string>

#include "core/model/scene.hpp"
#include "core/model/solver.hpp"

namespace taut {

/// Result of linear theory for a solver on a scene: small displacements about the start, links at
/// their rest length, no gravity, wind or contact.
struct LinearStability {
  double margin = 0;  ///< stable if at most 1: see `law`
  double growth = 0;  ///< of the fastest mode per step (or substep); 0: unknown
  std::string law;    ///< the stability condition, for people
  bool stable() const { return margin <= 1 + 1e-6; }
};

/// Linear stability of the solver, by the model that its entry declares
/// (SolverEntry::linear_model). Empty where no theory is known or its eigenvalues cannot be
/// computed.
///
/// LinearSprings, Verlet and symplectic Euler: with the stiffness K of springs and bending, masses
/// M, drag C, substep h and q = exp(-damping h), a mode becomes unstable when its multiplier
/// reaches -1:
///     lagged drag    h^2 K + 2 h C          against 2 (1 + q) M
///     central drag   h^2 K - (1 - q) h C    against 2 (1 + q) M
/// For one mass: h < (2/w)(sqrt(1 + zeta^2) - zeta), and 2/w without drag. `margin` is the largest
/// eigenvalue of M^-1/2 (left) M^-1/2 over 2 (1 + q), by Lanczos. Explicit Euler without drag or
/// damping grows by sqrt(1 + h^2 w^2) at every h; with drag and equal masses it is stable while
/// h < C/(M w^2), and h < 2 M/C.
///
/// LinearSweeps, at most 128 links: k sweeps G turn the predicted strains into e' = G^k ((1 + q) e
/// - q e''), so an eigenvalue mu of G^k gives the multipliers z^2 - (1 + q) mu z + q mu = 0.
/// `margin` and `growth` are the largest |z|, which does not depend on dt. One link with one sweep
/// is stable up to the relaxation factor 4/3.
std::optional<LinearStability> linear_stability(const Scene&, const SolverChoice&);

}  // namespace taut
