#pragma once

#include <string>
#include <vector>

#include "experiments/results/store.hpp"

namespace taut {

/// Sorts the solvers by the expected cost of a simulated second of this scene with their cheapest
/// setting, cheapest first. This is the least cost that was timed on a scene of this name, on any
/// machine. For a solver that was never timed, it is the number of items that its step visits,
/// times the median cost per item of the timed solvers. Solvers that cannot be estimated come last.
/// Nothing is run.
std::vector<std::string> by_expected_cost(std::vector<std::string> solvers,
                                          const std::string& scene, const SceneSettings&,
                                          const Store&);

/// Name of the best of an unfinished search: "cheapest so far; 3 solvers not tried, 2 not searched
/// to the end".
std::string so_far(const std::string& best, std::size_t not_tried, std::size_t cut_short);

}  // namespace taut
