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

/// The goal of a search: the best setting on a scene for an error or a budget.
struct AdviceWanted {
  std::string scene;  ///< name or path
  SceneSettings settings;
  std::vector<std::string> solvers;  ///< parameters fixed in their texts are not searched
  Target target;
  std::string metric = kErrorMetric;
  bool judged = false;             ///< whether it is known where the cloth should be
  std::vector<Limit> limits = {};  ///< limits on values besides the error
  double fps = 1 / kFrame;         ///< frames per second, for the unit in which costs are shown
  double patience = 120;           ///< s for everything
  int rounds = 8;                  ///< rounds in the timing of the finalists
  double seconds = 0.05;           ///< CPU time of a sample
  double tolerance = kTolerance;
  /// Receives a line for each setting that was tried.
  std::function<void(const std::string&)> news = {};
  std::function<void(std::size_t done, std::size_t total)> timing_round = {};

  Unit frame() const { return frame_cost(fps); }
};

/// Cost of a step of the cheapest setting without one effect of the scene.
struct Without {
  std::string effect;
  double cost = 0;  ///< CPU s per simulated s
};

struct Refused {
  std::string solver, why;
};

/// Result of a search.
struct Advice {
  Target target;
  /// If not even the cheapest settings fit the budget: the cheapest of all, with its quick cost.
  std::optional<Candidate> too_dear;
  std::vector<Without> without;  ///< its cost without each effect, the least first
  std::vector<Candidate> tried;
  std::vector<Refused> unsupported;  ///< solvers that cannot run the scene
  std::vector<std::string> cut;      ///< solvers whose search ended because --patience was used up
  std::vector<std::string> unrefined;  ///< solvers whose refinement ended for that reason
  SceneBench bench;
  Recommendation recommendation;
  Interval cost;  ///< expected cost of the best in a second session
  bool same_bits = false;
  Interval again;      ///< measured cost of the best in a second session
  double elapsed = 0;  ///< s that everything took

  const BenchedCase& best() const { return bench.cases[*recommendation.best]; }
  bool complete() const { return cut.empty() && unrefined.empty(); }
  /// Name of the best: if the search was cut short, it is only the best so far.
  std::string called() const;
  bool confirmed() const { return cost.contains(again.mid); }
};

/// Searches, times the finalists against each other and verifies the best, all within the patience.
/// Throws InputError if the scene, a solver or a limit is not valid.
Advice find_advice(const AdviceWanted&, Store&);

}  // namespace taut
