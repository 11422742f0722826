#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "experiments/results/store.hpp"
#include "experiments/study/limits.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

/// A setting that a search tried: its physics over the whole run, its cost by a few steps.
struct SettingTrial {
  Candidate candidate;
  double cpu = 0;       ///< s that the solver took for both, of what is stored already too
  double slowdown = 1;  ///< wall over CPU time of the few steps
};

/// Runs and times it; nothing: not done by the deadline. Refused is what fails, goes beyond the
/// limits, or hardly moves where the error is a strain.
std::optional<SettingTrial> try_setting(const Case&, Store&, const std::string& metric,
                                        const std::vector<Limit>& limits,
                                        std::chrono::steady_clock::time_point deadline);

/// CPU s per simulated s of a few steps. Throws std::runtime_error (it cannot be timed), TimeIsUp.
StepTime quick_time(const CaseSpec&, int steps, std::chrono::steady_clock::time_point deadline);

}  // namespace taut
