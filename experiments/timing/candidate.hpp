#pragma once

#include <optional>
#include <span>
#include <string>

#include "experiments/timing/statistics.hpp"

namespace taut {

/// One setting of one solver on one scene: what it costs and how far it is off.
struct Candidate {
  std::string solver;   ///< the entry's name
  std::string setting;  ///< "jakobsen:substeps=16,iterations=1"
  Interval cost;        ///< CPU seconds per simulated second
  double error = 0;     ///< of the chosen metric, >= 0; NaN if the metric has no meaning here
  std::string failure;  ///< why it is refused, such as "exploded (energy)"; empty: it ran
};

/// What is asked for: the cheapest setting within an error, or the most accurate within a cost.
/// Exactly one is set.
struct Target {
  std::optional<double> error;   ///< of the metric, its SI unit
  std::optional<double> budget;  ///< CPU seconds per simulated second

  /// A failure meets nothing.
  bool meets(const Candidate&) const;
  /// Whether a serves the target better than b; one that meets it beats all that do not.
  bool prefers(const Candidate& a, const Candidate& b) const;
};

/// The candidate of `solver` ("" = any) that serves the target best; nothing: none meets it.
std::optional<std::size_t> best_for(const Target&, std::span<const Candidate>,
                                    const std::string& solver = "");

/// Where a search for a setting ends.
inline constexpr int kMostSubsteps = 1024, kMostSweeps = 128;

/// The errors and budgets for which a bench answers, and of what they are unless asked otherwise.
inline constexpr const char* kErrorMetric = "stretch.rms";
inline constexpr double kErrorLevels[] = {0.1, 0.01, 0.001, 0.0001};
inline constexpr double kFrame = 1.0 / 60;  ///< s; budgets are CPU time within it
inline constexpr double kFrameBudgets[] = {0.1e-3, 0.5e-3, 1e-3, 4e-3, 16e-3};  ///< s per frame

}  // namespace taut
