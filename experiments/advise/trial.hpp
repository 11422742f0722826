#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "experiments/results/store.hpp"
#include "experiments/study/limits.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

/// A setting that a search tried: its physics over the whole run, and its cost over a few steps.
struct SettingTrial {
  Candidate candidate;
  double cpu = 0;       ///< s that the solver took for both, including stored results
  double slowdown = 1;  ///< ratio of wall to CPU time of the few steps
};

/// Runs and times a setting; nothing if it is not done by the deadline. judge() says whether it
/// counts.
std::optional<SettingTrial> try_setting(const Case&, Store&, const std::string& metric,
                                        const std::vector<Limit>& limits,
                                        std::chrono::steady_clock::time_point deadline);

/// Mean time of a step over a few steps [s]. Throws std::runtime_error if it cannot be timed, or
/// TimeIsUp.
StepTime quick_time(const CaseSpec&, int steps, std::chrono::steady_clock::time_point deadline);

}  // namespace taut
