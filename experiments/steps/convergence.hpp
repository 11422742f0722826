#pragma once

#include <string>
#include <vector>

#include "core/model/solver.hpp"
#include "core/reference/implicit_step.hpp"

namespace taut {

/// A solver's result after a number of iterations of one step.
struct ConvergencePoint {
  int iterations = 0;
  double residual = 0;  ///< N, norm of the gradient of the step's energy; NaN if links are rigid
  double stretch = 0;   ///< m, root mean square of the links' length minus rest length
  /// (G_k - G*)/(G_0 - G*), with G the step's energy. With rigid links, the square of the
  /// mass-weighted distance from the exact step, relative to that of the prediction. NaN if there
  /// is no exact step.
  double gap = 0;
  double distance = 0;      ///< m, RMS distance from the exact step; NaN without one
  double milliseconds = 0;  ///< CPU time of the step, the least of three
};

/// How a solver's iterations approach the exact solution of one step.
struct Convergence {
  std::string solver;  ///< solver text without iterations and substeps
  /// Why the solver cannot take the step; empty if it can, otherwise the members below have no
  /// meaning.
  std::vector<std::string> refused;
  Stiffness stiffness{};                 ///< stiffness of its links [N/m]; infinite: rigid
  std::string problem;                   ///< why its step has no exact solution; "" if it has
  double exact_residual = 0;             ///< N, residual that Newton's method left
  double moved = 0;                      ///< m, how far the last round of the exact step moved it
  std::vector<ConvergencePoint> points;  ///< in ascending order of iterations
  /// Factor of the distance per iteration, over the last third; NaN if unknown.
  double contraction = 0;
  double floor = 0;  ///< m, distance at which the iterations stay; 0 if they do not
};

/// State of a run of `from` at time `at` [s]; the scene's start if `at` is 0.
State state_at(const Scene&, const SolverChoice& from, double at);

/// Takes one step of scene.dt from `state` at time `at` [s] with each of the solvers, without
/// substeps, with 1, 2, 3, 4, 6, 8, ... up to `most` iterations. Each step starts anew from that
/// state.
std::vector<Convergence> converge(const Scene&, const State& state, double at,
                                  const std::vector<std::string>& solvers, int most);

/// Index of the first point from which on the gap is at most `gap`; -1 if there is no such point.
int reached(const Convergence&, double gap);

}  // namespace taut
