#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/results/store.hpp"
#include "experiments/study/limits.hpp"
#include "experiments/timing/recommendation.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

/// What is asked of a search: the best setting of a scene for an error or a budget.
struct AdviceWanted {
  std::string scene;  ///< name or path
  SceneSettings settings;
  std::vector<std::string> solvers;  ///< what their texts fix is not searched
  Target target;
  std::string metric = kErrorMetric;
  std::vector<Limit> limits = {};  ///< of values beside the error
  double fps = 1 / kFrame;         ///< frames a second, in which costs are shown
  double patience = 120;           ///< s for all of it
  int rounds = 8;                  ///< of the timing of the finalists
  double seconds = 0.05;           ///< of a sample
  double tolerance = kTolerance;
  std::function<void(const std::string&)> news = {};  ///< a line for each setting that was tried
  std::function<void(std::size_t done, std::size_t total)> timing_round = {};

  Unit frame() const { return frame_cost(fps); }
};

/// What a step of the cheapest setting costs without one effect of the scene.
struct Without {
  std::string effect;
  double cost = 0;  ///< CPU s per simulated s
};

struct Refused {
  std::string solver, why;
};

/// What was searched and found.
struct Advice {
  Target target;
  /// Where not even the cheapest settings fit the budget: the cheapest of all with its quick cost,
  /// and what it would cost without each effect, the least first.
  std::optional<Candidate> too_dear;
  std::vector<Without> without;
  std::vector<Candidate> tried;
  std::vector<Refused> unsupported;    ///< solvers that cannot run the scene
  std::vector<std::string> cut;        ///< solvers whose search --patience ended
  std::vector<std::string> unrefined;  ///< and those of which it ended what follows the search
  SceneBench bench;
  Recommendation recommendation;
  Interval cost;  ///< of the best, as it is expected in a second session
  bool same_bits = false;
  Interval again;      ///< cost of the best in a second session
  double elapsed = 0;  ///< s that all of it took

  const BenchedCase& best() const { return bench.cases[*recommendation.best]; }
  bool complete() const { return cut.empty() && unrefined.empty(); }
  /// What the best is called: that of a search that was ended is not the best.
  std::string called() const;
  bool confirmed() const { return cost.contains(again.mid); }
};

/// Searches, times the finalists against each other and verifies the best, all within the patience.
/// Throws InputError: the scene, a solver or what is kept cannot be.
Advice find_advice(const AdviceWanted&, Store&);

}  // namespace taut
