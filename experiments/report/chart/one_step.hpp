#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/report/chart/charts.hpp"
#include "experiments/timing/convergence.hpp"

namespace taut::report {

/// From what the solvers were asked for a step.
struct StepState {
  std::string scene, settings;  ///< its name, and what is set of it: "cloth.span=0.7"
  std::string from;             ///< solver whose run gave the state
  double at = 0, dt = 0;        ///< s, time of the state and the step
};
/// What `taut converge` found of these.
Answer one_step_answer(const StepState&, const std::vector<Convergence>&);

/// What `taut converge` found, read back from its answer with a record for each of its points, so
/// that they are drawn as cases are: kSweeps, and the values that step_kinds() names.
struct OneStep {
  Answer found;
  std::vector<Record> records;

  explicit OneStep(Answer);
  /// Its scene with what is set of it, "drape, cloth.span=0.7".
  std::string scene() const;
  /// Title of one of its solvers, with its parameters where several have that title.
  std::string label(const std::string& solver) const;
};

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
