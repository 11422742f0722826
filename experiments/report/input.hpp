#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/lab/bench.hpp"
#include "experiments/lab/record.hpp"
#include "experiments/report/figures.hpp"

namespace taut::report {

/// A study that was run, or as much of it as there is.
struct StudyResult {
  std::string name;      ///< "iterations"
  std::string question;  ///< one sentence
  std::vector<Record> records;
  std::size_t planned = 0;               ///< cases in all; 0: as many as there are records
  std::map<std::string, double> slopes;  ///< by scene: the theory's exponent of stretch over sweeps
};

/// A study over two settings, run along the borders between outcomes.
struct MapResult {
  std::string study, question;
  std::string x, y;  ///< names that value_of() knows
  std::vector<Record> records;
  std::vector<Record> inferred;  ///< were not run: their neighbours say how they end
};

struct SolverInfo {
  std::string name, summary, source;
};

struct SceneInfo {
  std::string name, summary;
};

/// A picture or video of a scene, held as bytes so that the report stays one file.
struct Clip {
  std::string type;    ///< "video/mp4" or "image/png"
  std::string bytes;   ///< the file
  std::string poster;  ///< PNG shown before a video plays and in print; may be empty
  std::string alt;     ///< what is to be seen, for those who cannot see it
  /// Who is in it, from left to right: solver's name and its settings.
  std::vector<std::pair<std::string, std::string>> panels;
};

/// What was rendered of a scene. Videos of one scene start together and last equally long.
struct SceneMedia {
  std::string scene;
  std::vector<Clip> clips;
  double duration = 0;       ///< s of simulated time that a video covers
  double speed = 1;          ///< simulated seconds per second of video
  std::vector<Clip> stills;  ///< strain in material space, in order of time; caption in `alt`
};

/// A closed form or a published number beside what a solver gave.
struct TruthRow {
  std::string name, solver, statement, expected, measured;
  bool holds = false;
};

/// A case whose numbers left the tolerance of the committed baseline.
struct RegressionRow {
  std::string id, value, baseline, now;
  bool worse = true;
};

/// Everything that a report is made of. Empty parts become a line that says which command makes
/// them.
struct ReportInput {
  std::string title;    ///< "": from the solvers' names
  std::string command;  ///< the command line that made it all
  std::vector<std::pair<std::string, std::string>> provenance;  ///< "compiler" -> "g++ 12.2.0"
  std::vector<SolverInfo> solvers;
  std::vector<SceneInfo> scenes;
  std::vector<StudyResult> studies;
  std::vector<MapResult> maps;
  std::vector<TimeSeries> series;  ///< over time, for the scene on top and its playhead
  std::vector<SceneMedia> media;
  std::optional<BenchSession> bench;            ///< what accuracy costs; nullopt: not timed
  std::optional<std::vector<TruthRow>> truths;  ///< nullopt: not run
  std::optional<std::vector<RegressionRow>> regressions;  ///< nullopt: not checked
};

/// The value under which timing puts its result into a record [s per step].
inline constexpr const char* kCpuValue = "cpu.per_step";

}  // namespace taut::report
