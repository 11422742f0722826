#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/history/history.hpp"

namespace taut {

/// "3f2a9c1d0e" of a commit, others as they are.
std::string short_build(const std::string& id);

/// Steps of one value of one solver at one build, in one sentence: "stretch.rms of hang rose from
/// 2.1 to 2.6 % at 3f2a9c1d0e (2026-05-04)".
struct SteppedValue {
  const HistoryStep* largest = nullptr;
  std::size_t cases = 0;
  std::string sentence;
};
/// Statuses, costs, values that answer a question (a role), then the others; of each the largest
/// first.
std::vector<SteppedValue> stepped_values(const History&);

/// Sentences, and tables of steps, of builds, of gaps and, of `value`, of rows and of all that was
/// measured.
Answer answer_of(const History&, const std::string& value);

/// A <testsuites> of JUnit: a test for every case of the last build that has results, failed where
/// it stepped; skipped where it has none.
std::string junit(const History&);

}  // namespace taut
