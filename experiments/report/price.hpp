#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/timing/bench.hpp"

namespace taut::report {

/// The question that heads the report: what does this error cost?
inline constexpr const char* kPricedMetric = "stretch.rms";
inline constexpr double kPricedError = 0.01;

/// Whether a ratio of costs is a difference: its interval excludes 1, the change exceeds 5 % and
/// exceeds what the same code showed against itself. Unlike judge(), a noisy machine does not
/// silence a factor of four.
bool told_apart(const Interval& ratio, const Interval& control);

/// How far the same code strayed from itself, as a share: 0.03 for an interval 0.98 to 1.03.
double strayed(const Interval& control);

/// What the error costs two solvers on one scene, each with its own cheapest setting.
struct ScenePrice {
  std::string scene;
  std::optional<std::size_t> first, other;  ///< cases of the bench; nothing: never reached
  bool other_ran = false;                   ///< it was timed at all
  std::optional<Interval> ratio;            ///< cost of the other over that of the first
  bool apart = false;                       ///< told_apart
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
