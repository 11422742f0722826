#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut {

/// How a bench is judged and shown.
struct BenchReport {
  std::vector<double> levels;         ///< errors that are asked for
  std::string metric = kErrorMetric;  ///< whose value is the error
  double tolerance = 0;               ///< relative differences below it do not count
  bool of_study = true;               ///< people see who is best for what; else the cases
};

/// What `taut bench` prints.
Answer bench_answer(const StudyBench&, const BenchReport&);

}  // namespace taut
