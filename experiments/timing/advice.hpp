#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/timing/bench.hpp"
#include "experiments/timing/search.hpp"

namespace taut {

/// How sure an answer is.
enum class Certainty {
  clear,   ///< the interval of the ratio to the runner-up excludes 1 by more than the tolerance and
           ///< by more than the same code strays from itself; a budget is met by the whole interval
  likely,  ///< the interval says so, but this machine strays as much or the margin is small
  a_tie,   ///< the two cannot be told apart
  unopposed  ///< nobody else grants the wish
};
std::string_view to_string(Certainty);

/// Which of the finalists serves the wish best, by costs from one interleaved session.
struct Advice {
  std::optional<std::size_t> best;  ///< index into the finalists; nothing: none grants the wish
  std::optional<std::size_t> runner_up;  ///< the best of another solver, else of the same
  std::optional<Interval> ratio;         ///< cost of the runner-up over that of the best
  Certainty certainty = Certainty::unopposed;
};
Advice judge_finalists(const SceneBench& finalists, const Wish&, const std::string& metric,
                       double tolerance);

/// Who deserves a believable timing: the best by quick cost of every solver that grants the wish,
/// at most `most`, then the next best of the leader. Indices into `tried`, best first.
std::vector<std::size_t> finalists(const std::vector<Offer>& tried, const Wish&, std::size_t most);

}  // namespace taut
