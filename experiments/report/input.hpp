#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/case/record.hpp"
#include "experiments/history/history.hpp"
#include "experiments/report/footage.hpp"
#include "experiments/results/store.hpp"
#include "experiments/steps/one_step.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"
#include "experiments/system/json.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::report {

/// A value of one case over simulated time.
struct TimeSeries {
  std::string scene;
  std::string solver;     ///< the entry's name
  std::string label;      ///< "Jakobsen, 8 sweeps"
  std::string value;      ///< "stretch.rms"
  std::vector<double> t;  ///< s
  std::vector<double> y;  ///< SI; NaN: no value at this time
  std::string key = {};   ///< key of the case; "": not stored
  double floor = 0;       ///< strain caused by the rounding in a file of positions; 0: none
};

/// A study that was run, completely or in part.
struct StudyResult {
  std::string name;      ///< "iterations"
  std::string question;  ///< one sentence
  std::vector<Record> records;
  std::size_t planned = 0;  ///< number of planned cases; 0: as many as there are records
  std::map<std::string, double> slopes;  ///< by scene: theoretical exponent of stretch over sweeps
};

/// A study over two settings, which shows how its cases end.
struct MapResult {
  std::string study, question;
  std::string x, y;             ///< names that value_of() knows
  std::vector<Record> records;  ///< if empty, those of the study with that name
};

struct SolverInfo {
  std::string name, summary, source;
  /// Reasons why the solver would misread scenes, each with the shipped scenes to which it applies.
  std::vector<std::pair<std::string, std::vector<std::string>>> unsupported{};
};

struct SceneInfo {
  std::string name, summary;
};

/// The film or picture of a scene.
struct SceneMedia {
  /// Its panels, from left to right.
  struct Panel {
    std::string solver, settings;
    std::string key = {};  ///< key of the case; "": no study ran it
  };
  std::string scene;
  Footage footage = {};
  std::vector<Panel> panels = {};
  std::string summary = {};  ///< of a scene that no study ran
  /// Solvers of the comparison that refuse the scene, and why.
  std::vector<std::pair<std::string, std::string>> refused = {};
};

/// Findings of `taut verify`.
struct Truths {
  Json shown = {};  ///< `truths` of the model (model/MODEL.md)
  /// Current verdict on each assertion of a publication, and the number on which it rests.
  std::map<std::string, std::pair<std::string, std::string>> assertions = {};
};

/// Differences between two results folders, of two builds or two machines.
struct Differences {
  std::string a, b;                              ///< their paths
  std::vector<std::pair<Record, Record>> pairs;  ///< cases that both folders have
  std::vector<std::pair<BenchedCase, BenchedCase>> timed;
  std::size_t only_a = 0, only_b = 0;  ///< cases that the other folder lacks
  /// Largest difference of identical code from itself in either folder, as a share.
  double noise = 0;
};

/// Everything from which a report is made. Where a part is empty, the page names the command that
/// makes it.
struct ReportInput {
  std::string question = {};  ///< heading of the page; "": none
  std::string title;          ///< "": made from the solvers' names
  std::string command;        ///< command line that made all of it
  std::string vectors = {};   ///< instructions that simd=auto chooses on this machine: "avx2"
  /// Hosts that measured the cost of this study, and which of them are shown.
  std::vector<std::string> cost_hosts;
  std::vector<std::pair<std::string, std::string>> provenance;  ///< "compiler" -> "g++ 12.2.0"
  std::map<std::string, Spent> spent = {};  ///< CPU time that cases took, by key
  std::vector<SolverInfo> solvers;
  std::vector<SceneInfo> scenes;
  std::vector<StudyResult> studies;
  std::vector<MapResult> maps;
  std::vector<TimeSeries> series;  ///< over time, shown with the playhead of the film on top
  std::vector<SceneMedia> media;
  std::optional<StudyBench> bench;              ///< cost of accuracy; nullopt: not timed
  std::optional<Truths> truths;                 ///< nullopt: not run
  std::optional<Json> regressions;              ///< in the form of the model; nullopt: not checked
  std::optional<Differences> differences = {};  ///< nullopt: there is only one folder
  Json required = {};  ///< rows of the model's table; null: no scene was examined
  std::vector<ParameterFrontier> frontiers = {};  ///< solver by solver, parameter by parameter
  std::vector<OneStep> steps = {};                ///< findings of `taut converge`, scene by scene
  std::vector<History> histories = {};            ///< histories of the studies, build by build
  /// Inputs that could not be read, with the reason; the page names them.
  std::vector<std::pair<std::string, std::string>> left_out = {};
};

}  // namespace taut::report
