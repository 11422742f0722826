#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

/// How to judge and show a bench.
struct BenchReport {
  std::vector<double> levels;  ///< errors to answer for; none: levels_of() the metric
  std::string metric = {};     ///< value that is the error; "": the one that decides on each scene
  double tolerance = 0;        ///< smaller relative differences are ignored
  /// Whether people see which solver is best for what, rather than the cases.
  bool of_study = true;
};

/// The answer of `taut bench`.
Answer bench_answer(const StudyBench&, const BenchReport&);

}  // namespace taut
