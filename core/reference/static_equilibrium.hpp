#pragma once

#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut::reference {

/// Where a cloth of rods comes to rest under gravity, to rounding.
struct Equilibrium {
  bool unique = false;          ///< false: no truth; nothing below but `reason` has a meaning
  std::string reason;           ///< why there is no unique truth, one sentence
  std::string derivation;       ///< how it was found, one sentence
  std::vector<Vec3> x;          ///< [n] m
  std::vector<double> tension;  ///< [links] N, >= 0: pulls; empty if not unique (redundant rods)
  double unbalanced = 0;        ///< N, largest force left on a free vertex
  double violation = 0;         ///< m, largest | |x_b - x_a| - rest |
  double floor = 0;             ///< m, distance between two independent solutions
};

/// Why no unique equilibrium is known for this scene, one sentence each; empty: one may exist and
/// static_equilibrium decides. Contact, self-collision, wind, bending, elastic links, moving pins
/// and the absence of gravity or pins are refused here (truths without a unique answer).
std::vector<std::string> refuse_static(const Scene&);

/// Minimum of the potential energy over all placements whose links keep their lengths.
///
/// 1. Vertices on a shortest path between two fixed ones that is exactly as long as their distance
///    are fixed; a vertex that can hang at the full length of its shortest path below a fixed one
///    does. If that decides every vertex, this is the answer, without any iteration.
/// 2. Otherwise the convex relaxation |x_b - x_a| <= rest: augmented Lagrangian (Powell, Hestenes,
///    Rockafellar) with positive-definite Newton steps and a sparse LDLT, then Newton on the KKT
///    system of the links that pull, regularised to be quasi-definite, with iterative refinement.
///    By convexity a stationary point with tensions >= 0 is a global minimum; it is also the
///    cloth's if every link, pulling or not, has its full length there. It is the only one: halfway
///    to another minimum a pulling link that differs between them would be slack, and pulling links
///    join every vertex, which has weight, to a pin. If not - a sheet whose shear links lock, links
///    that would have to push - there is no unique truth.
/// Never throws; a numerical failure is a reason.
Equilibrium static_equilibrium(const Scene&);

}  // namespace taut::reference
