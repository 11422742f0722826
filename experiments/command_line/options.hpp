#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/model/input_error.hpp"
#include "experiments/baseline/baseline_study.hpp"
#include "experiments/case/case.hpp"
#include "experiments/command_line/output.hpp"
#include "experiments/results/session.hpp"
#include "experiments/study/isolate.hpp"
#include "experiments/study/study.hpp"
#include "experiments/system/read_all.hpp"

namespace taut {

/// Validator for a number above 0.
CLI::Validator above_zero();
/// Validator for seconds above 0, at most kLongestSeconds.
CLI::Validator above_zero_seconds();

/// Validator for one of these names. Its message suggests the nearest and lists all if they are
/// few.
CLI::Validator known(const std::string& what, std::vector<std::string> names);

/// Validator for the name of a metric's value, such as "stretch.rms".
CLI::Validator metric_value();

/// -j: number of cases at a time; by default one per core.
CLI::Option* add_jobs(CLI::App&, int& jobs);

/// --out: the results folder; by default default_results().
CLI::Option* add_results(CLI::App&, std::string& folder);

/// --preset: the preset of a study.
CLI::Option* add_preset(CLI::App&, std::string& preset);

/// --set: settings of a scene, once for each.
CLI::Option* add_settings(CLI::App&, SceneSettings&);

/// SCENE: a scene, by name or file.
CLI::Option* add_scene(CLI::App&, std::string& scene);

/// STUDY: a study, by name or file.
CLI::Option* add_study(CLI::App&, std::string& study);

/// --solver of a verb that takes several. `what` describes the purpose of each; the help adds
/// "repeat it for each".
CLI::Option* add_solvers(CLI::App&, std::vector<std::string>& solvers, const std::string& what);

/// --record: stores what a verb finds for the report.
void add_record(CLI::App&, bool& record);

/// --timeout and --memory of a case. The values passed are the defaults.
void add_limits(CLI::App&, Limits&);

/// --preset and --out, of earlier runs.
void add_stored(CLI::App&, std::string& preset, std::string& results);

/// -o: the file or folder that a verb writes.
CLI::Option* add_output(CLI::App&, std::string& path, const std::string& what);

/// --rounds and --seconds of a timing. The values passed are the defaults.
void add_samples(CLI::App&, int& rounds, double& seconds, int fewest_rounds = 1);

/// --metric, whose value is the error, and --tolerance for costs.
void add_judgement(CLI::App&, std::string& metric, double& tolerance);

/// --baselines: the folder of the baselines.
void add_baselines(CLI::App&, std::string& folder);

/// Options with the functions that run cases, print news and name values.
BaselineOptions baseline_options();

/// Options of all verbs about baselines: --baselines, --out, -j, and baseline_options().
void add_baseline_options(CLI::App&, BaselineOptions&);

/// --json, --csv and --markdown for an answer; also --all if it has `details` that people rarely
/// want.
void add_format(CLI::App&, Format&, const char* details = nullptr);

/// --json, which prints `what` instead.
CLI::Option* add_json(CLI::App&, bool& json, const std::string& what);

/// load_study(), which also throws InputError if a figure that the study requests cannot be drawn.
Study load_study_to_plot(const std::string& name_or_path, const std::string& preset);
/// load_study_to_plot() for several studies, each with these time steps (at_time_steps()).
std::vector<Study> load_studies_to_plot(const std::vector<std::string>& names_or_paths,
                                        const std::string& preset,
                                        const std::vector<std::string>& steps);
/// The cases of each study.
std::vector<StudyCases> cases_of_each(const std::vector<Study>&);

/// Hint at presets of a study whose cases are all stored: "; preset quick has all of its results:
/// --preset quick"; "" if there is no such preset.
std::string where_else(const Study&, const Store&);
/// The study as words of a command: "iterations --preset quick".
std::string study_words(const Study&);

/// Throws InputError with all errors in these solver texts.
void check_solvers(const std::vector<std::string>& texts);

/// Prints on stderr what was skipped in the files of these scenes, one line each.
void tell_remarks(const std::vector<std::string>& remarks);

/// Options that change a scene: [--dt] [--duration] [--fabric] [--set key=value ...].
class SceneChanges {
 public:
  void bind(CLI::App&);
  /// The changes as settings of the scene. Throws InputError if two have the same key.
  SceneSettings settings() const;
  bool has_duration() const { return !duration_.empty(); }

 private:
  std::string dt_, duration_;
  SceneSettings settings_;
};

/// Options that name one case: SCENE, SOLVER and changes to the scene.
class CaseOptions {
 public:
  void bind(CLI::App&);
  CaseSpec spec() const;  ///< as typed
  /// Throws InputError.
  Case make() const;

 private:
  std::string scene_, solver_;
  SceneChanges changes_;
};

/// Replaces this process by the program that can run the choice, with the same arguments; returns
/// if that is this program. Throws InputError if the other program is not installed.
void continue_in_right_program(const SolverChoice&);

/// Value of --error: "0.01" or "1%". A share of 1 or more needs its "%", since 5 might mean 5 %.
/// Throws InputError.
double error_of(const std::string& text, const Unit&);

/// The words with which this program was started.
std::vector<std::string> typed_words();
std::string typed_command();

}  // namespace taut
