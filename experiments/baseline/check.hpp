#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/baseline/baseline_study.hpp"

namespace taut {

/// How studies compare with their baselines; of several studies the greatest counts.
enum class CheckEnd { passed, not_run, nothing, moved, environment, conflict, interrupted };

/// Names of the studies that have a baseline in this folder, sorted.
std::vector<std::string> studies_with_baseline(const std::string& folder);

struct Check {
  Answer answer;
  CheckEnd end = CheckEnd::passed;
  std::size_t cases = 0;  ///< compared
  std::string junit;      ///< what was found, as a file of JUnit's
};

/// Compares these studies with their baselines, all that have one if none is named; runs what is
/// missing. `strict`: another toolchain ends a study as `environment`. Throws InputError.
Check check_studies(std::vector<std::string> studies, const BaselineOptions&, bool strict = false);

}  // namespace taut
