#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/baseline/frontier_baseline.hpp"
#include "experiments/results/store.hpp"

namespace taut::report {

/// Whether answers are compared with the baseline or become the baseline.
enum class Baseline { ignore, check, update };

/// Request of `taut frontier --all`: how far every parameter of one or two solvers goes.
struct EveryFrontierWanted {
  std::vector<std::string> solvers;  ///< "bullet:iterations=4"
  Baseline baseline = Baseline::ignore;
  std::string baselines;  ///< folder of the baselines
  int jobs = 1;
  /// Called before each solver. Returns the function to call after each of its parameters.
  std::function<std::function<void(std::size_t done, std::size_t all)>(const std::string& solver)>
      countdown;
};

struct EveryFrontier {
  Answer answer;
  std::vector<FrontierCheck> checks;  ///< one for each solver, unless the baseline is ignored
  std::string no_picture;             ///< why there is no picture; "" if there is one
};

/// Finds the frontiers, stores the answer of each solver, and draws the picture in the store's
/// folder. Returns nothing if interrupted. Throws InputError.
std::optional<EveryFrontier> find_every_frontier(const EveryFrontierWanted&, Store&);

}  // namespace taut::report
