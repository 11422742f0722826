#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/baseline/baseline_study.hpp"

namespace taut {

/// How the comparison of studies with their baselines ended. With several studies, the greatest
/// counts.
enum class CheckEnd { passed, not_run, nothing, moved, environment, conflict, interrupted };

/// Names of the studies that have a baseline in this folder, sorted.
std::vector<std::string> studies_with_baseline(const std::string& folder);

struct Check {
  Answer answer;
  CheckEnd end = CheckEnd::passed;
  std::size_t cases = 0;  ///< number compared
  std::string junit;      ///< findings as a JUnit file
};

/// Compares these studies with their baselines, or all studies that have one if none are named, and
/// runs the missing cases. If `strict`, a different toolchain makes a study end as `environment`.
/// Throws InputError.
Check check_studies(std::vector<std::string> studies, const BaselineOptions&, bool strict = false);

}  // namespace taut
