#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/case/record.hpp"
#include "experiments/steps/convergence.hpp"

namespace taut {

/// Question of `taut converge`.
struct StepQuestion {
  std::string scene;  ///< name or path
  SceneSettings settings;
  std::vector<std::string> solvers;
  /// Solver whose run gives the state. The exact step is near the state of a solver whose links
  /// hardly deviate; jakobsen's state is far from satisfying its links.
  std::string from = "implicit:structural=1e5,shear=1e5,bend=1e5";
  double at = 0.5;  ///< s, time of the state
  int most = 256;   ///< largest number of iterations
};
/// Answers the question. Throws InputError.
Answer one_step(const StepQuestion&);

/// The state from which the solvers took a step.
struct StepState {
  std::string scene, settings;  ///< name of the scene, and its settings: "cloth.span=0.7"
  std::string from;             ///< solver whose run gave the state
  double at = 0, dt = 0;        ///< s, time of the state and length of the step
};
Answer one_step_answer(const StepState&, const std::vector<Convergence>&);

/// How the iterations of a solver end.
struct StepSolver {
  std::string text;        ///< "vbd:structural=800"
  double structural = 0;   ///< stiffness [N/m]; NaN: rigid
  double contraction = 0;  ///< factor of the distance per further iteration
  double floor = 0;  ///< m, distance of another fixed point where they end; NaN: no such point
  double moved = 0;  ///< m, last correction of the exact step
  /// Distance from the exact step [m], by number of iterations.
  std::map<int, double> distances = {};
  /// Iterations after which the gap stays below a value, by that value.
  std::map<double, int> iterations = {};
};

/// Findings of `taut converge`, read back from its answer.
struct OneStep {
  std::string subject;          ///< "one step of drape, cloth.span=0.7"
  std::string scene, settings;  ///< name of the scene, and its settings
  std::vector<StepSolver> solvers;
  /// A record for each point, so that points can be drawn like cases: with their sweeps, and the
  /// values that step_kinds() lists.
  std::vector<Record> records;

  explicit OneStep(const Answer&);
  std::string titled_scene() const;  ///< "drape, cloth.span=0.7"
};

/// Values that can be drawn over the iterations of a step: "distance", "gap", "stretch",
/// "residual".
std::vector<std::string> step_kinds();
/// Name of a value: "step.distance" for "distance". Throws InputError with a suggestion.
std::string step_value(std::string_view kind);

}  // namespace taut
