#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/timing/study_bench.hpp"

namespace taut {

/// A cost to be compared with others.
struct Cost {
  std::size_t at = 0;     ///< index of the case or column that has the cost
  double mid = 0;         ///< any unit
  bool is_bound = false;  ///< the cost is at most that
};

/// A cost beside another one.
struct Rival {
  std::size_t at = 0;
  std::optional<Interval> times;          ///< over the other one; nothing: they cannot be compared
  Certainty certainty = Certainty::none;  ///< of these times
  bool is_bound = false;

  /// Whether it is surely the higher cost: neither noise nor an untried setting can make the
  /// difference.
  bool is_dearer() const;
};

/// The least of several costs, and the others beside it.
struct Cheapest {
  std::size_t at = 0;
  std::vector<Rival> rivals;  ///< by rising cost

  /// Whether there are others, and all are dearer.
  bool is_told() const;
};

/// Cost i over cost j; nothing: not both were timed in turns.
using RatioOf = std::function<std::optional<Interval>(std::size_t i, std::size_t j)>;

/// Finds the least of these costs and compares the others with it. All code that calls a setting
/// the cheapest uses this function. Precondition: there is a cost.
Cheapest cheapest_of(std::vector<Cost>, const RatioOf&, const Interval& control,
                     double tolerance = kTolerance);

/// A scene of a bench with its cases judged by their error. They are judged only once, because each
/// of their intervals takes a bootstrap.
struct JudgedScene {
  SceneBench bench;
  std::string metric;
  std::vector<Candidate> candidates;  ///< of its cases, in their order, judged by the metric

  /// "": the metric that decides on the scene.
  explicit JudgedScene(SceneBench, const std::string& metric = "");
  bool has(const std::string& solver) const;
  /// The case of the solver ("" = any) that serves the target best; nothing: none meets it.
  std::optional<std::size_t> best(const Target&, const std::string& solver = "") const;
  /// The same of each solver that meets it, in order of appearance.
  std::vector<std::size_t> best_of_each(const Target&) const;
  /// Why no setting of the solver ("" = any) serves the target (taut::why_not()).
  Cell why_not(const Target&, const std::string& solver = "") const;
  /// Whether the case's cost is only an upper bound: no setting of the same solver with less cost
  /// or less work was tried, though there is one (the case does more than one sweep in one
  /// substep).
  bool is_upper_bound(std::size_t at) const;
  /// A case beside another one.
  Rival beside(std::size_t at, std::size_t other, double tolerance = kTolerance) const;
  /// Which of these cases is the cheapest. Precondition: there is a case.
  Cheapest cheapest(const std::vector<std::size_t>& cases) const;
};

}  // namespace taut
