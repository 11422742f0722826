#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/case/record.hpp"
#include "experiments/steps/convergence.hpp"

namespace taut {

/// What `taut converge` is asked.
struct StepQuestion {
  std::string scene;                  ///< name or path
  std::vector<std::string> settings;  ///< of the scene
  std::vector<std::string> solvers;
  /// Solver whose run gives the state. Of one whose links hardly deviate the exact step is near;
  /// jakobsen's state is far off its links.
  std::string from = "implicit:structural=1e5,shear=1e5,bend=1e5";
  double at = 0.5;  ///< s, time of the state
  int most = 256;   ///< iterations
};
/// Throws InputError.
Answer one_step(const StepQuestion&);

/// From what the solvers were asked for a step.
struct StepState {
  std::string scene, settings;  ///< its name, and what is set of it: "cloth.span=0.7"
  std::string from;             ///< solver whose run gave the state
  double at = 0, dt = 0;        ///< s, time of the state and the step
};
Answer one_step_answer(const StepState&, const std::vector<Convergence>&);

/// What `taut converge` found, read back from its answer with a record for each of its points, so
/// that they are drawn as cases are: their sweeps, and the values that step_kinds() names.
struct OneStep {
  Answer found;
  std::vector<Record> records;

  explicit OneStep(Answer);
  /// Its scene with what is set of it, "drape, cloth.span=0.7".
  std::string scene() const;
};

/// What can be drawn over the iterations of a step: "distance", "gap", "stretch", "residual".
std::vector<std::string> step_kinds();
/// "step.distance" of "distance". Throws InputError with a suggestion.
std::string step_value(std::string_view kind);

}  // namespace taut
