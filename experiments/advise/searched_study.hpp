#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/study.hpp"

namespace taut {

/// The solvers that a search may choose from: all except external programs and recorded motions.
std::vector<std::string> solvers_to_search();

/// Searches all solvers of a study, with `cpu` seconds for each on each scene, and writes the file
/// that the study's key `searched` names. Returns what was searched and what is missing. `news`
/// receives a line after each solver. Throws InputError if the study names no file or has axes, or
/// a scene has errors; or Interrupted.
Answer search_study(const Study&, Store&, const std::string& metric, double cpu,
                    const std::function<void(const std::string&)>& news);

}  // namespace taut
