#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/case/record.hpp"
#include "experiments/steps/convergence.hpp"

namespace taut {

/// What `taut converge` is asked.
struct StepQuestion {
  std::string scene;  ///< name or path
  SceneSettings settings;
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

/// How the iterations of a solver end.
struct StepSolver {
  std::string text;                       ///< "vbd:structural=800"
  double structural = 0;                  ///< stiffness [N/m]; NaN: rigid
  double contraction = 0;                 ///< of the distance, by each further iteration
  double floor = 0;                       ///< m, where another fixed point ends them; NaN: nowhere
  double moved = 0;                       ///< m, last correction of the exact step
  std::map<int, double> distances = {};   ///< from the exact step [m], by iterations
  std::map<double, int> iterations = {};  ///< until the gap stays below a value, by that value
};

/// What `taut converge` found, read back from its answer.
struct OneStep {
  std::string subject;          ///< "one step of drape, cloth.span=0.7"
  std::string scene, settings;  ///< its name, and what is set of it
  std::vector<StepSolver> solvers;
  /// One for each point, so that they are drawn as cases are: their sweeps, and the values that
  /// step_kinds() names.
  std::vector<Record> records;

  explicit OneStep(const Answer&);
  std::string titled_scene() const;  ///< "drape, cloth.span=0.7"
};

/// What can be drawn over the iterations of a step: "distance", "gap", "stretch", "residual".
std::vector<std::string> step_kinds();
/// "step.distance" of "distance". Throws InputError with a suggestion.
std::string step_value(std::string_view kind);

}  // namespace taut
