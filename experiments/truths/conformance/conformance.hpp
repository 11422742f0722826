#pragma once

#include <functional>
#include <string>

#include "experiments/truths/truth.hpp"

/// One test of each phenomenon, for any solver, elementary ones first: what comes later rests on
/// what comes before, so that the first that fails names the error. Each truth of section 11 runs
/// the solvers that were asked for, or all of this program. Its tolerance allows for float32 and
/// for what consistent integrators differ by.
namespace taut::conformance {

/// Calls `check` for each solver. A solver given by name alone is converged: in double and with a
/// thousand sweeps; one given with parameters, and a program of its own, is left as it is. A
/// failure of the solver breaks the truth for this solver alone.
void for_each_solver(Findings&, const std::function<void(const std::string& solver)>& check);

constexpr double kFine = 1.0 / 256;  ///< s, the step where closed forms are of continuous time

/// Four vertices of different masses at the corners of a square, with two faces and no links.
Scene square();

/// Stiffness [N/m] of the springs that the solver has in place of the scene's rigid links, as it
/// says itself; infinite: it says nothing, or that they are rigid.
double own_stiffness(const std::string& solver, const Scene&);

/// Time [s] at which `height` first passes 0, from above, linear between two steps; NaN: not within
/// `seconds`.
double first_passage(Simulation&, double seconds, const std::function<double()>& height);

}  // namespace taut::conformance
