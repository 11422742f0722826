#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/reference/fit.hpp"
#include "experiments/case/case.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

/// One solver setting on growing cloths.
struct ScalingLine {
  std::string setting;               ///< brief: "jakobsen:iterations=4"
  std::vector<BenchedCase> cases;    ///< by rising number of vertices
  std::vector<std::string> skipped;  ///< "512 x 512: expected to take 310 s of 60"
  std::optional<PowerLaw> cpu;       ///< CPU seconds per step over vertices
  std::optional<PowerLaw> wall;      ///< wall seconds per step over vertices
  std::optional<PowerLaw> memory;    ///< bytes of the passes of a step over vertices
};

/// Measures a case that is expected to take so long [s] (0: nobody knows): its record, its samples,
/// and how long both took [s].
struct Measured {
  BenchedCase benched;
  double seconds = 0;
};
using Measure = std::function<Measured(const Case&, double expected)>;

/// Cases grouped by solver setting and measured by rising size. A case that, going by the one
/// before it and the ratio of their sizes, would take more than `limit` seconds is skipped, and so
/// are all larger ones. Exponents are fitted to the cases that ended ok or unsettled.
std::vector<ScalingLine> measure_scaling(const std::vector<Case>&, double limit, const Measure&);

/// Bytes that the passes of a step hold, of all together.
double plan_bytes(const Record&);

}  // namespace taut
