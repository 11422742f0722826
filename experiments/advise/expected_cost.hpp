#pragma once

#include <string>
#include <vector>

#include "experiments/results/store.hpp"

namespace taut {

/// The solvers, the cheapest first, by what a simulated second of this scene is expected to cost
/// with the cheapest setting of each: the least that was timed on a scene of this name, on whatever
/// machine; of a solver that was never timed, the items that its step visits, each as dear as those
/// of the timed solvers in the mean. Who cannot be asked is last. Nothing is run.
std::vector<std::string> by_expected_cost(std::vector<std::string> solvers,
                                          const std::string& scene, const SceneSettings&,
                                          const Store&);

/// What the best of a search is called that was not finished: "cheapest so far; 3 solvers not
/// tried, 2 not searched to the end".
std::string so_far(const std::string& best, std::size_t not_tried, std::size_t cut_short);

}  // namespace taut
