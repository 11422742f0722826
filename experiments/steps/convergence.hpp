#pragma once

#include <string>
#include <vector>

#include "core/model/solver.hpp"
#include "core/reference/implicit_step.hpp"

namespace taut {

/// A solver after k iterations of one step.
struct ConvergencePoint {
  int iterations = 0;
  double residual = 0;  ///< N, |gradient| of the step's energy; NaN: links are rigid
  double stretch = 0;   ///< m, root mean square of the links' length - rest length
  double gap = 0;       ///< (G_k - G*)/(G_0 - G*); rigid: square of the distance to the exact step,
                        ///< weighted by mass, over that of the prediction. NaN: no exact step
  double distance = 0;  ///< m, RMS from the exact step; NaN: there is none
  double milliseconds = 0;  ///< CPU time of the step, the least of three
};

/// How a solver's iterations go towards the exact solution of one step.
struct Convergence {
  std::string solver;                    ///< without its iterations and substeps
  std::vector<std::string> refused;      ///< why it cannot be asked; nothing below has a meaning
  Stiffness stiffness{};                 ///< of its links [N/m]; infinite: rigid
  std::string problem;                   ///< why its step has no exact solution; "": it has
  double exact_residual = 0;             ///< N, what Newton's method left
  double moved = 0;                      ///< m, how far its last round still moved it
  std::vector<ConvergencePoint> points;  ///< iterations ascending
  double contraction =
      0;             ///< factor of the distance per iteration over the last third; NaN: unknown
  double floor = 0;  ///< m, distance at which it stays; 0: none was reached
};

/// The state at `at` [s] of a run of `from`; at 0 the scene's start.
State state_at(const Scene&, const SolverChoice& from, double at);

/// One step of scene.dt from `state` at time `at` [s] by each of the solvers, with 1, 2, 3, 4, 6,
/// 8, ... up to `most` iterations, each anew from that state and without substeps.
std::vector<Convergence> converge(const Scene&, const State& state, double at,
                                  const std::vector<std::string>& solvers, int most);

/// Index of the first point from which on the gap stays at most `gap`; -1: it does not get there.
int reached(const Convergence&, double gap);

}  // namespace taut
