#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/study/study.hpp"
#include "experiments/timing/scaling.hpp"

namespace taut {

struct ScalingOptions {
  /// Error for which each solver gets as many sweeps as it needs, or substeps if it has one sweep
  /// in each; nothing: as many as the case has. Of kVerdict or, at sizes without a reference, of
  /// RMS stretch.
  std::optional<double> error;
  /// Longest time of a case in all [s], for physics, search and timing; longer cases are skipped.
  double limit = 20;
  int samples = 6;                              ///< samples of each case
  std::function<void(const std::string&)> say;  ///< receives the name of each case that starts
};

/// Runs and times the study's cases in order of size, and stores the measurements as a bench of
/// cases that were not timed in turns. Throws InputError, Interrupted.
std::vector<ScalingLine> bench_scaling(const Study&, Store&, const ScalingOptions&);

/// The answer of `taut bench scaling`.
Answer scaling_answer(const std::string& study, const std::vector<ScalingLine>&);

}  // namespace taut
