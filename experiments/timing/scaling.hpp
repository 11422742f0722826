#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/reference/fit.hpp"
#include "experiments/case/case.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

/// One solver setting on cloths of growing size.
struct ScalingLine {
  std::string setting;               ///< brief text: "jakobsen:iterations=4"
  std::vector<BenchedCase> cases;    ///< in order of increasing number of vertices
  std::vector<std::string> skipped;  ///< "512 x 512: expected to take 310 s of 60"
  std::optional<PowerLaw> cpu;       ///< CPU seconds per step over vertices
  std::optional<PowerLaw> wall;      ///< wall seconds per step over vertices
  std::optional<PowerLaw> memory;    ///< bytes that the passes of a step hold, over vertices
};

/// A measured case: its record and samples, and how long both took [s].
struct Measured {
  BenchedCase benched;
  double seconds = 0;
};
/// Measures a case that is expected to take `expected` [s] (0: unknown).
using Measure = std::function<Measured(const Case&, double expected)>;

/// Groups cases by solver setting and measures them in order of increasing size. Skips a case, and
/// all larger ones, if it would take more than `limit` seconds, going by the previous case and the
/// ratio of their sizes. Exponents are fitted to the cases that ended ok or unsettled.
std::vector<ScalingLine> measure_scaling(const std::vector<Case>&, double limit, const Measure&);

/// Bytes that the passes of a step hold in total.
double plan_bytes(const Record&);

}  // namespace taut
