#pragma once

#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut::reference {

/// Equilibrium of a cloth of rods under gravity, to rounding.
struct Equilibrium {
  bool unique = false;          ///< false: no truth; only `reason` has a meaning
  std::string reason;           ///< why there is no unique truth, one sentence
  std::string derivation;       ///< how it was found, one sentence
  std::vector<Vec3> x;          ///< [n] m
  std::vector<double> tension;  ///< [links] N, >= 0: pulls; empty if not unique (redundant rods)
  double unbalanced = 0;        ///< N, largest force left on a free vertex
  double violation = 0;         ///< m, largest | |x_b - x_a| - rest |
  double floor = 0;             ///< m, distance between two independent solutions
};

/// Reasons, one sentence each, why gravity, links and pins do not decide where the cloth rests:
/// contact, self-collision, wind, moving pins, seams, or no gravity or pins.
std::vector<std::string> refuse_rest(const Scene&);

/// Reasons, one sentence each, why no unique equilibrium of this scene is known. Empty: one may
/// exist, and static_equilibrium() decides. Refused here are those of refuse_rest(), bending and
/// elastic links (truths without a unique answer).
std::vector<std::string> refuse_static(const Scene&);

/// Minimises the potential energy over all positions in which links keep their lengths.
///
/// 1. Vertices on a shortest path between two fixed ones that is exactly as long as their distance
///    are fixed. A vertex that can hang at the full length of its shortest path below a fixed one
///    does. If this decides every vertex, it is the answer, without any iteration.
/// 2. Otherwise the convex relaxation |x_b - x_a| <= rest is solved: augmented Lagrangian (Powell,
///    Hestenes, Rockafellar) with positive-definite Newton steps and a sparse LDLT, then Newton on
///    the KKT system of the links that pull, regularised to be quasi-definite, with iterative
///    refinement. By convexity a stationary point with tensions >= 0 is a global minimum; it is
///    also the cloth's if every link, pulling or not, has its full length there. It is the only
///    minimum: halfway to another one a pulling link that differs between them would be slack, and
///    pulling links join every vertex, which has weight, to a pin. Otherwise, with a sheet whose
///    shear links lock or links that would have to push, there is no unique truth.
/// Never throws; a numerical failure is a reason.
Equilibrium static_equilibrium(const Scene&);

}  // namespace taut::reference
