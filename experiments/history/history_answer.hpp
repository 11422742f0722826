#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/history/history.hpp"

namespace taut {

/// Short form of a commit's hash, "3f2a9c1d0e"; any other id is returned unchanged.
std::string short_build(const std::string& id);

/// The change of a status in a step: "ok to exploded (energy)".
std::string status_change(const History&, const HistoryStep&);

/// Steps of one value of one solver at one build, with a sentence: "stretch.rms of hang rose from
/// 2.1 to 2.6 % at 3f2a9c1d0e (2026-05-04)".
struct SteppedValue {
  const HistoryStep* largest = nullptr;
  std::size_t cases = 0;
  std::string sentence;
};
/// Sorted by kind: statuses, costs, values that answer a question (with a role), other values;
/// within each kind the largest step comes first.
std::vector<SteppedValue> stepped_values(const History&);

/// The history as sentences and as tables of steps, builds and gaps, and for `value` tables of rows
/// and of all measurements.
Answer answer_of(const History&, const std::string& value);

/// A JUnit <testsuites> with a test for each case of the last build that has results. The test
/// fails if the case stepped and is skipped if it has no result.
std::string junit(const History&);

}  // namespace taut
