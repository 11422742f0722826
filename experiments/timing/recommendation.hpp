#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

/// How a solver's best setting serves a target.
struct SolverRecommendation {
  std::string solver;
  std::optional<std::size_t> at;  ///< index of the case; nothing: not reached
  std::optional<Interval> times;  ///< its cost over that of the best of all
};

/// Which of the timed cases serves a target best, and how well every solver does.
struct Recommendation {
  Target target;
  std::vector<SolverRecommendation> solvers;  ///< in order of appearance
  std::optional<std::size_t> best;            ///< index of the case; nothing: none meets the target
  std::optional<std::size_t> runner_up;  ///< the best of another solver, else the next of the same
  std::optional<Interval> ratio;         ///< cost of the runner-up over that of the best
  /// For a target error: judge() of that ratio. For a budget: clear if the whole interval of the
  /// cost meets it, else likely.
  Certainty certainty = Certainty::unopposed;
  double tolerance = kTolerance;  ///< the smallest difference that matters
};
Recommendation recommend(const SceneBench&, const Target&, const std::string& metric,
                         double tolerance = kTolerance);

/// The cost to expect of a case in another session [CPU s per simulated s]: its interval, widened
/// by how far identical code strayed from itself in this one.
Interval cost_expected_again(const SceneBench&, std::size_t at);

/// "stretch.rms <= 1 %" or "least stretch.rms within 4 ms a frame of 1/60 s".
std::string text(const Target&, const std::string& metric, double fps = 1 / kFrame);

/// The certainty of the best in words: "clearly within the budget", "likely cheaper than bullet",
/// "costs the same as bullet within 5 %". Precondition: there is a best.
std::string verdict(const Recommendation&, const SceneBench&);

/// How near a solver came that missed the target, and whether it could have reached the target.
std::string nearest(const SolverRecommendation&, const SceneBench&, const Recommendation&,
                    const std::string& metric);

/// An empty table of recommendations. add() appends the rows of one: the best, then every other
/// solver with its cost or how near it came.
Table recommendations(const std::string& metric);
void add(Table&, const Recommendation&, const SceneBench&, const std::string& metric);

/// Which settings to time: the best setting, by quick cost, of every solver that meets the target,
/// at most `most`; then the next best of the leader. Indices into `tried`, best first.
std::vector<std::size_t> finalists(const std::vector<Candidate>& tried, const Target&,
                                   std::size_t most);

}  // namespace taut
