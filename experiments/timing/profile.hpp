#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/timing/study_bench.hpp"

namespace taut {

/// How often a solver is close to the best (Dolan & More, Benchmarking optimization software with
/// performance profiles, Math. Program. 91, 2002). A problem is an error to be reached on a scene.
/// The cost of a solver for it is that of its cheapest setting that reaches the error.
struct PerformanceProfile {
  std::string solver;
  /// The solver's cost relative to the best solver's, at least 1, by problem; infinite if none of
  /// its settings reaches the error, for whatever reason.
  std::vector<double> ratios;

  /// Share of the problems for which its cost is within this factor of the best; 0 without
  /// problems.
  double share(double factor) const;
};

/// Profiles over all scenes and the error levels of a metric, in order of appearance, from all
/// settings that were timed. Problems that no solver solves are left out.
std::vector<PerformanceProfile> performance_profiles(const std::vector<SceneBench>&,
                                                     const std::string& metric,
                                                     std::span<const double> levels);

}  // namespace taut
