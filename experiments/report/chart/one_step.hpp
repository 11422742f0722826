#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/report/chart/charts.hpp"

namespace taut::report {

/// What `taut converge` found, with a record for each of its points, so that they are drawn as
/// cases are: kSweeps, and the values that step_kinds() names.
struct OneStep {
  Answer found;
  std::vector<Record> records;

  explicit OneStep(Answer);
  /// Its scene with what is set of it, "drape, cloth.span=0.7".
  std::string scene() const;
  /// Title of one of its solvers, with its parameters where several have that title.
  std::string label(const std::string& solver) const;
};

/// An answer's subject is this and its scene.
inline constexpr std::string_view kOneStep = "one step of ";

/// What can be drawn over the iterations of a step: "distance", "gap", "stretch", "residual".
std::vector<std::string> step_kinds();
/// "step.distance" of "distance". Throws InputError with a suggestion.
std::string step_value(std::string_view kind);

/// The records with a value above 0, which a logarithmic axis shows. Throws InputError if there is
/// none.
Records step_records(const OneStep&, std::string_view kind);
/// Points into the records. Throws as step_records().
Chart step_chart(const OneStep&, std::string_view kind);

}  // namespace taut::report
