#pragma once

#include <string>
#include <vector>

namespace taut {

/// The job that `taut run` runs, and `taut report` shows, if no study is named: main-job.toml in
/// data_folder().
struct MainJob {
  std::string preset;                ///< preset of all its studies
  std::vector<std::string> studies;  ///< studies to compare
  std::vector<std::string> maps;     ///< studies of where solvers break
  std::string bench;                 ///< study to time
  /// Scenes ("name:key=value,...") of which one step is followed, under the solvers of the first
  /// study.
  std::vector<std::string> steps;

  /// The compared studies, then the maps.
  std::vector<std::string> studies_to_run() const;
};

/// Throws InputError with all errors of the file.
MainJob main_job();

}  // namespace taut
