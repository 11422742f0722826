#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "experiments/timing/study_bench.hpp"

namespace taut {

/// Runs a setting ("jakobsen:iterations=1,substeps=16"); nothing: time is up, search no further.
using Evaluation = std::function<std::optional<Candidate>(const std::string& setting)>;

/// How far a search goes: its columns alone; all of it; or all of it, and then again from its best
/// until nothing is better.
enum class SearchDepth { columns, refined, repeated };

/// Looks for the setting of `solver` (its text fixes what it names) that serves the target best,
/// and returns all that it tried. It walks the accuracy parameters of the
/// solver's entry, not their grid:
///   1. columns of the second parameter (sweeps, or a stiffness): in each, the fewest substeps that
///      reach the error by doubling, from half of what the column before needed; or the most that
///      the budget allows. Two columns without progress end it, as does a cost far above what
///      `known`, the candidates of others, have. Of a solver with sweeps and a stiffness: its
///      default stiffness, and where that does not reach the error, the next higher.
///   2. error: bisection of the substeps, then of the sweeps, between the last doubling.
///   3. the entry's alternatives, one at a time, other stiffnesses among them; each with as few
///      substeps as it then needs.
/// Repeated: of what reached nothing, 1 with each alternative; then half and twice the sweeps of
/// the best, and 2 and 3 again. Substeps are not doubled to more than `dearest` [CPU s per
/// simulated s].
std::vector<Candidate> search_settings(const std::string& solver, const Target&, const Evaluation&,
                                       std::vector<Candidate> known = {},
                                       SearchDepth depth = SearchDepth::refined,
                                       double dearest = std::numeric_limits<double>::infinity());

/// The setting of `solver` that costs least: one substep, and the first of the second parameter's
/// values, as far as the text leaves them open.
std::string cheapest_setting(const std::string& solver);

/// The solvers by what their cheapest setting costs, the least first and failures last: a search
/// whose time is up has then tried what is cheap, and knows whom the dear ones have to beat.
std::vector<std::string> cheapest_first(std::vector<std::string> solvers, const Evaluation&);

}  // namespace taut
