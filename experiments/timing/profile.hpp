#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiments/timing/study_bench.hpp"

namespace taut {

/// How often a solver is near the best (Dolan & More, Benchmarking optimization software with
/// performance profiles, Math. Program. 91, 2002). A problem is an error to be reached on a scene;
/// a solver's cost of it is that of its cheapest setting that gets there.
struct PerformanceProfile {
  std::string solver;
  /// By problem: its cost over that of the best, at least 1; infinite if no setting gets there, for
  /// whatever reason.
  std::vector<double> ratios;

  /// Share of the problems in which it is within this factor of the best; 0 without problems.
  double share(double factor) const;
};

/// Profiles over all scenes and the error levels of a metric, in order of appearance. Every solver
/// has as many settings of a scene as the one with the fewest, spread over those that were timed:
/// who was tried oftener has no advantage. Problems that nobody solves are left out.
std::vector<PerformanceProfile> performance_profiles(const std::vector<SceneBench>&,
                                                     const std::string& metric,
                                                     std::span<const double> levels = kErrorLevels);

}  // namespace taut
