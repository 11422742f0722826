#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "experiments/timing/study_bench.hpp"

namespace taut {

/// Runs a setting ("jakobsen:iterations=1,substeps=16"). Returns nothing if time is up, which ends
/// the search.
using Evaluation = std::function<std::optional<Candidate>(const std::string& setting)>;

/// The fewest substeps with which a setting, whose text leaves them open, is expected to reach an
/// error. Nothing: nobody knows.
using Expectation = std::function<std::optional<int>(const std::string& setting, double error)>;

/// Extent of a search: only the columns; everything; or everything, repeated from its best until
/// nothing improves.
enum class SearchDepth { columns, refined, repeated };

/// Searches the setting of `solver` that serves the target best, and returns all that it tried.
/// Parameters in the solver's text are fixed. The search follows the accuracy parameters of the
/// solver's entry without covering their grid:
///   1. Columns of the second parameter (sweeps, or a stiffness). For an error, each column finds
///      by doubling the fewest substeps that reach it, from half of what the previous column
///      needed; it starts where the error is expected, if that is known, and goes on from there by
///      tenths. For a budget, the most substeps that it allows. The columns end after two
///      without progress, or at a cost far above that of `known`, the candidates of other solvers.
///      A solver with sweeps and a stiffness starts with its default stiffness and takes the next
///      higher ones only if that does not reach the error.
///   2. For an error: bisection of the substeps, then of the sweeps, within the last doubling.
///   3. The entry's alternatives, one at a time, including other stiffnesses, each with as few
///      substeps as it then needs.
/// A repeated search tries 1 with each alternative if nothing has reached the target so far, then
/// half and twice the sweeps of the best, and then 2 and 3 again. Substeps are not doubled beyond a
/// cost of `dearest` [CPU s per simulated s].
std::vector<Candidate> search_settings(const std::string& solver, const Target&, const Evaluation&,
                                       std::vector<Candidate> known = {},
                                       SearchDepth depth = SearchDepth::refined,
                                       double dearest = std::numeric_limits<double>::infinity(),
                                       const Expectation& expected = {});

/// The cheapest setting of `solver`: one substep and the first value of the second parameter, where
/// its text leaves them open.
std::string cheapest_setting(const std::string& solver);

/// Sorts the solvers by the cost of their cheapest setting, with failures last. If time runs out, a
/// search has then tried the cheap ones, and the expensive ones know what they have to beat.
std::vector<std::string> cheapest_first(std::vector<std::string> solvers, const Evaluation&);

}  // namespace taut
