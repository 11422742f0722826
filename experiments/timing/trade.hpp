#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/timing/statistics.hpp"

namespace taut {

/// One setting of one solver on one scene: what it costs and how far it is off.
struct Offer {
  std::string solver;   ///< the entry's name
  std::string setting;  ///< "jakobsen:substeps=16,iterations=1"
  Interval cost;        ///< CPU seconds per simulated second
  double error =
      0;  ///< of the chosen metric, >= 0; NaN if the run failed or the metric has no meaning
  bool failed = false;  ///< status other than ok: never offered, never hidden
};

/// Indices of the offers that no other beats in both cost and error, by rising cost. Failures are
/// never among them.
std::vector<std::size_t> pareto_front(std::span<const Offer>);

/// The cheapest offer of `solver` ("" = any) whose error is at most `level`; nothing: never
/// reached.
std::optional<std::size_t> cheapest_within(std::span<const Offer>, const std::string& solver,
                                           double level);

/// The most accurate offer of `solver` ("" = any) whose cost is at most `budget` [CPU s per
/// simulated s].
std::optional<std::size_t> best_within(std::span<const Offer>, const std::string& solver,
                                       double budget);

/// The levels and budgets of the equal-error table.
inline constexpr double kErrorLevels[] = {0.1, 0.01, 0.001, 0.0001};
inline constexpr double kFrameBudgets[] = {0.1e-3, 0.5e-3, 1e-3, 4e-3,
                                           16e-3};  ///< CPU s per frame of 1/60 s

}  // namespace taut
