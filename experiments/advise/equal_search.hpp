#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/results/store.hpp"
#include "experiments/study/study.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

/// What a search of one solver on one scene of a study tried within its CPU time.
struct EqualSearch {
  std::string scene;  ///< as in Study::scenes
  std::string solver;
  std::vector<SearchedSetting> rows;
  /// Errors for which no setting was found, with the reason, one sentence each.
  std::vector<std::string> missing;
  double cpu = 0;        ///< s that the solver took; its last run may exceed the limit
  bool cut_off = false;  ///< whether time ended the search
};

/// Searches every solver of the study on every scene for the cheapest setting within each error.
/// Each solver gets the same CPU time, `seconds` per scene: half without the accelerators that
/// other solvers may lack, half with all parameters. Without a metric each scene has the one that
/// decides on it. An expensive solver is not abandoned because
/// others are cheap. Throws InputError if the study has axes or a scene has errors; or Interrupted.
std::vector<EqualSearch> search_equally(const Study&, Store&, const std::string& metric,
                                        double seconds,
                                        const std::function<void(const EqualSearch&)>& after_each);

}  // namespace taut
