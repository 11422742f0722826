#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/study.hpp"

namespace taut {

/// The solvers that a search may choose from: those that are no program or motion of others.
std::vector<std::string> solvers_to_search();

/// Searches all solvers of a study with `cpu` seconds for each on each scene, writes the file that
/// the study's key `searched` names, and returns what was searched and what is missing. `news` gets
/// a line after each solver. Throws InputError: the study names no file, has axes, or a scene is
/// wrong; Interrupted.
Answer search_study(const Study&, Store&, const std::string& metric, double cpu,
                    const std::function<void(const std::string&)>& news);

}  // namespace taut
