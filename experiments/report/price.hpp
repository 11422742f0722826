#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/timing/bench.hpp"

namespace taut::report {

/// The question that heads the report: what does this error cost?
inline constexpr const char* kPricedMetric = "stretch.rms";
inline constexpr double kPricedError = 0.01;

/// What the error costs two solvers on one scene, each with its own cheapest setting.
struct ScenePrice {
  std::string scene;
  std::optional<std::size_t> first, other;  ///< cases of the bench; nothing: never reached
  bool other_ran = false;                   ///< it was timed at all
  std::optional<Interval> ratio;            ///< cost of the other over that of the first
  bool apart = false;                       ///< is_significant
};

/// Over all scenes of a bench.
struct Price {
  std::vector<ScenePrice> scenes;
  std::optional<Interval> mean;  ///< geometric mean of the ratios of scenes that both reach
  double first_cost = 0;         ///< geometric means over those scenes, CPU s per simulated s
  double other_cost = 0;
  double strayed = 0;  ///< the largest over scenes
};

Price compare_price(const BenchSession&, const std::string& first, const std::string& other);

/// Geometric mean of independent ratios: their errors add as squares of logarithms.
Interval geometric_mean(const std::vector<Interval>&);

/// "2.3 (2.1–2.5)".
std::string with_interval(const Interval&, int digits = 2);

}  // namespace taut::report
