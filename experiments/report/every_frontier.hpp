#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/baseline/frontier_baseline.hpp"
#include "experiments/results/store.hpp"

namespace taut::report {

/// Whether answers are compared with the baseline, or become it.
enum class Baseline { ignore, check, update };

/// How far every parameter of one or two solvers goes: `taut frontier --all`.
struct EveryFrontierWanted {
  std::vector<std::string> solvers;  ///< "bullet:iterations=4"
  Baseline baseline = Baseline::ignore;
  std::string baselines;  ///< their folder
  int jobs = 1;
  /// Asked before each solver for what is then told of its parameters.
  std::function<std::function<void(std::size_t done, std::size_t all)>(const std::string& solver)>
      countdown;
};

struct EveryFrontier {
  Answer answer;
  std::vector<FrontierCheck> checks;  ///< of each solver, unless the baseline is ignored
  std::string no_picture;             ///< why none was drawn; "": one was
};

/// Keeps the answer of each solver in the store, and draws the picture in its folder. Nothing:
/// interrupted. Throws InputError.
std::optional<EveryFrontier> find_every_frontier(const EveryFrontierWanted&, Store&);

}  // namespace taut::report
