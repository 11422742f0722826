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

/// A check of an option's value: a number above 0.
CLI::Validator above_zero();
/// Seconds above 0, kLongestSeconds at most.
CLI::Validator above_zero_seconds();

/// One of these names; the message suggests the nearest and lists them if they are few.
CLI::Validator known(const std::string& what, std::vector<std::string> names);

/// The name of a metric's value, such as "stretch.rms".
CLI::Validator metric_value();

/// Cases at a time, as -j: one per core unless the user says otherwise.
CLI::Option* add_jobs(CLI::App&, int& jobs);

/// The results folder, as --out: default_results() unless the user says otherwise.
CLI::Option* add_results(CLI::App&, std::string& folder);

/// The preset of a study.
CLI::Option* add_preset(CLI::App&, std::string& preset);

/// Settings of a scene, as --set, once for each.
CLI::Option* add_settings(CLI::App&, SceneSettings&);

/// SCENE, one scene by its name or its file.
CLI::Option* add_scene(CLI::App&, std::string& scene);

/// STUDY, one study by its name or its file.
CLI::Option* add_study(CLI::App&, std::string& study);

/// --solver of a verb that takes several; `what` says what each is for, and "repeat it for each"
/// follows.
CLI::Option* add_solvers(CLI::App&, std::vector<std::string>& solvers, const std::string& what);

/// --record, which keeps what a verb finds for the report.
void add_record(CLI::App&, bool& record);

/// --timeout and --memory of a case; they stand for the defaults.
void add_limits(CLI::App&, Limits&);

/// --preset and --out of what was run.
void add_stored(CLI::App&, std::string& preset, std::string& results);

/// What a verb writes, as -o: a file or a folder.
CLI::Option* add_output(CLI::App&, std::string& path, const std::string& what);

/// --rounds and --seconds of a timing; they stand for the defaults.
void add_samples(CLI::App&, int& rounds, double& seconds, int fewest_rounds = 1);

/// --metric, whose value is the error, and --tolerance of costs.
void add_judgement(CLI::App&, std::string& metric, double& tolerance);

/// The folder of the baselines, as --baselines.
void add_baselines(CLI::App&, std::string& folder);

/// How verbs run cases, print news and name values.
BaselineOptions baseline_options();

/// What every verb about baselines has: --baselines, --out, -j, and baseline_options().
void add_baseline_options(CLI::App&, BaselineOptions&);

/// --json, --csv and --markdown of an answer; --all if it has `details` that people rarely want.
void add_format(CLI::App&, Format&, const char* details = nullptr);

/// --json, which prints `what` instead.
CLI::Option* add_json(CLI::App&, bool& json, const std::string& what);

/// load_study(); throws InputError, too, if a figure that the study asks for cannot be drawn.
Study load_study_to_plot(const std::string& name_or_path, const std::string& preset);
/// The same of several, each at these time steps (at_time_steps()).
std::vector<Study> load_studies_to_plot(const std::vector<std::string>& names_or_paths,
                                        const std::string& preset,
                                        const std::vector<std::string>& steps);
/// The cases of each study.
std::vector<StudyCases> cases_of_each(const std::vector<Study>&);

/// "; preset quick has all of its results: --preset quick", of the presets of a study of which
/// every case is stored; "" if there is none.
std::string where_else(const Study&, const Store&);
/// "iterations --preset quick": the study in a command.
std::string study_words(const Study&);

/// Throws InputError with everything that is wrong with any of these solvers' texts.
void check_solvers(const std::vector<std::string>& texts);

/// Says on stderr what was skipped of the files of these scenes, a line each.
void tell_remarks(const std::vector<std::string>& remarks);

/// How verbs change a scene: [--dt] [--duration] [--fabric] [--set key=value ...].
class SceneChanges {
 public:
  void bind(CLI::App&);
  /// As settings of the scene. Throws InputError if two of them are of the same key.
  SceneSettings settings() const;
  bool has_duration() const { return !duration_.empty(); }

 private:
  std::string dt_, duration_;
  std::vector<std::string> settings_;
};

/// How verbs name one case: SCENE SOLVER and the changes to the scene.
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

/// Replaces this process by the program that can run the choice (same arguments), if it is another
/// one; returns if it is this. Throws InputError if the other is not installed.
void continue_in_right_program(const SolverChoice&);

/// What --error says, "0.01" or "1%". A share of 1 or more is only known with its "%": 5 may be 5
/// %. Throws InputError.
double error_of(const std::string& text, const Unit&);

/// The words with which this program was started, and the same for a shell: "taut check -j 2".
std::vector<std::string> typed_words();
std::string typed_command();

}  // namespace taut
