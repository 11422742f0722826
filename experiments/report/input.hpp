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
  std::vector<double> y;  ///< SI; NaN: no value at this moment
  std::string key = {};   ///< of the case; "": it is not stored
  double floor = 0;  ///< strain that the rounding of a file of positions makes; 0: there is none
};

/// A study that was run, or as much of it as there is.
struct StudyResult {
  std::string name;      ///< "iterations"
  std::string question;  ///< one sentence
  std::vector<Record> records;
  std::size_t planned = 0;               ///< cases in all; 0: as many as there are records
  std::map<std::string, double> slopes;  ///< by scene: the theory's exponent of stretch over sweeps
};

/// A study over two settings: how its cases end.
struct MapResult {
  std::string study, question;
  std::string x, y;             ///< names that value_of() knows
  std::vector<Record> records;  ///< empty: those of the study of that name
};

struct SolverInfo {
  std::string name, summary, source;
  /// What it would misread: a reason and the shipped scenes to which it applies.
  std::vector<std::pair<std::string, std::vector<std::string>>> unsupported{};
};

struct SceneInfo {
  std::string name, summary;
};

/// What was rendered of a scene.
struct SceneMedia {
  /// Who is in it, from left to right.
  struct Panel {
    std::string solver, settings;
    std::string key = {};  ///< of the case; "": no study ran it
  };
  std::string scene;
  Footage footage = {};
  std::vector<Panel> panels = {};
  std::string summary = {};  ///< of a scene that no study ran
  /// Solvers of the comparison that refuse the scene, and why.
  std::vector<std::pair<std::string, std::string>> refused = {};
};

/// What `taut verify` found.
struct Truths {
  Json shown = {};  ///< `truths` of the model (model/MODEL.md)
  /// By assertion of a publication: its verdict now, and the number that it rests on.
  std::map<std::string, std::pair<std::string, std::string>> assertions = {};
};

/// Two results folders, of two builds or two machines.
struct Differences {
  std::string a, b;                              ///< their paths
  std::vector<std::pair<Record, Record>> pairs;  ///< cases that both have
  std::vector<std::pair<BenchedCase, BenchedCase>> timed;
  std::size_t only_a = 0, only_b = 0;  ///< cases that the other one lacks
  double noise =
      0;  ///< largest difference of identical code from itself in either folder, as a share
};

/// Everything that a report is made of. In place of an empty part the page names the command that
/// makes it.
struct ReportInput {
  std::string question = {};  ///< that heads the page; "": none
  std::string title;          ///< "": from the solvers' names
  std::string command;        ///< the command line that made it all
  std::string vectors = {};   ///< the instructions that simd=auto chooses on this machine: "avx2"
  std::vector<std::string> cost_hosts;  ///< where this study's cost was measured, and what is shown
  std::vector<std::pair<std::string, std::string>> provenance;  ///< "compiler" -> "g++ 12.2.0"
  std::vector<SolverInfo> solvers;
  std::vector<SceneInfo> scenes;
  std::vector<StudyResult> studies;
  std::vector<MapResult> maps;
  std::vector<TimeSeries> series;  ///< over time, for the scene on top and its playhead
  std::vector<SceneMedia> media;
  std::optional<StudyBench> bench;              ///< what accuracy costs; nullopt: not timed
  std::optional<Truths> truths;                 ///< nullopt: not run
  std::optional<Json> regressions;              ///< of the model; nullopt: not checked
  std::optional<Differences> differences = {};  ///< nullopt: one folder alone
  Json required = {};  ///< rows of the model's table; null: no scene was asked about
  std::vector<ParameterFrontier> frontiers = {};  ///< solver by solver, parameter by parameter
  std::vector<OneStep> steps = {};                ///< of `taut converge`, scene by scene
  std::vector<History> histories = {};            ///< of the studies, build by build
  /// Inputs that could not be read, and why; the page names them.
  std::vector<std::pair<std::string, std::string>> left_out = {};
};

}  // namespace taut::report
