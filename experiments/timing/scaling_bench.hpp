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
  /// Each solver with as many substeps of one sweep, or sweeps if it has more than one, as this
  /// RMS stretch takes; nothing: as the case asks.
  std::optional<double> error;
  double limit = 20;  ///< s; a case that would take longer, physics, search and timing, is skipped
  int samples = 6;    ///< of each case
  std::function<void(const std::string&)> say;  ///< gets the name of each case that begins
};

/// Runs and times the study's cases by rising size, and keeps what it measured as a bench of cases
/// that were not timed in turns. Throws InputError, Interrupted.
std::vector<ScalingLine> bench_scaling(const Study&, Store&, const ScalingOptions&);

/// What `taut bench scaling` prints of it.
Answer scaling_answer(const std::string& study, const std::vector<ScalingLine>&);

}  // namespace taut
