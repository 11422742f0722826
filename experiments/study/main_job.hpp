#pragma once

#include <string>
#include <vector>

namespace taut {

/// What `taut run` without a study runs and `taut report` without one shows: main-job.toml of
/// data_folder().
struct MainJob {
  std::string preset;                ///< of all its studies
  std::vector<std::string> studies;  ///< that are compared
  std::vector<std::string> maps;     ///< studies of where solvers break
  std::string bench;                 ///< the study that is timed
  /// Scenes ("name:key=value,...") of which one step is followed, by the first study's solvers.
  std::vector<std::string> steps;

  /// Those that are compared, then the maps.
  std::vector<std::string> studies_to_run() const;
};

/// Throws InputError with everything that is wrong with the file.
MainJob main_job();

}  // namespace taut
