#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/results/store.hpp"
#include "experiments/study/study.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

/// What a search tried of one solver on one scene of a study, within its CPU time.
struct EqualSearch {
  std::string scene;  ///< as in Study::scenes
  std::string solver;
  std::vector<SearchedSetting> rows;
  /// For which errors no setting was found, and why, a sentence each.
  std::vector<std::string> missing;
  double cpu = 0;        ///< s that the solver took; the last run may go beyond what it had
  bool cut_off = false;  ///< it would have tried more
};

/// Searches every solver of the study on every scene for the cheapest setting within each error,
/// each solver with as much CPU time as any other [s a scene]: half of it without accelerators
/// that others may lack, the rest with all of its levers. Who is dear is not given up because
/// others are cheap. Throws InputError: the study has axes, or a scene is wrong; Interrupted.
std::vector<EqualSearch> search_equally(const Study&, Store&, const std::string& metric,
                                        const std::vector<double>& errors, double seconds,
                                        const std::function<void(const EqualSearch&)>& after_each);

}  // namespace taut
