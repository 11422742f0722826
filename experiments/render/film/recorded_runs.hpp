#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/case/run_case.hpp"
#include "experiments/render/picture/scene_renderer.hpp"

namespace taut {

/// Runs to be drawn: one scene under several solvers.
struct RunRequest {
  std::string scene;  ///< name or path
  SceneSettings settings;
  std::vector<std::string> solvers;  ///< "jakobsen:iterations=8"
};

struct RunSet {
  Scene scene;
  std::vector<RecordedRun> runs;  ///< with titles and colours
  std::vector<Series> series{};   ///< of the solvers: values over time
};

/// Runs every solver on the scene, each in a process of its own and all at once, and keeps every
/// step. A run that explodes, crashes or hangs is kept up to its last stable state. Calls `say`
/// with what is being run. Throws InputError if the scene or a solver is unknown, or a solver
/// cannot represent the scene.
RunSet record_runs(const RunRequest&, const std::function<void(const std::string&)>& say);

}  // namespace taut
