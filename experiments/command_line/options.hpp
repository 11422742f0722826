#pragma once

#include <string>
#include <vector>

#include "core/model/input_error.hpp"
#include "experiments/case/case.hpp"
#include "experiments/command_line/arguments.hpp"
#include "experiments/command_line/conditions.hpp"
#include "experiments/command_line/output.hpp"
#include "experiments/results/session.hpp"
#include "experiments/study/isolate.hpp"
#include "experiments/study/study.hpp"

namespace taut {

/// -j: number of cases at a time; by default one per core.
Argument& add_jobs(Arguments&, int& jobs);

/// --out: the results folder; by default default_results().
Argument& add_results(Arguments&, std::string& folder);

/// --preset: the preset of a study.
Argument& add_preset(Arguments&, std::string& preset);

/// --set: settings of a scene, once for each.
Argument& add_settings(Arguments&, SceneSettings&);

/// SCENE: a scene, by name or file.
Argument& add_scene(Arguments&, std::string& scene);

/// STUDY: a study, by name or file.
Argument& add_study(Arguments&, std::string& study);

/// --solver of a verb that takes several. `what` describes the purpose of each; the help adds
/// "repeat it for each".
Argument& add_solvers(Arguments&, std::vector<std::string>& solvers, const std::string& what);

/// --record: stores what a verb finds for the report.
void add_record(Arguments&, bool& record);

/// --timeout and --memory of a case. The values passed are the defaults.
void add_limits(Arguments&, Limits&);

/// --preset and --out, of earlier runs.
void add_stored(Arguments&, std::string& preset, std::string& results);

/// -o: the file or folder that a verb writes.
Argument& add_output(Arguments&, std::string& path, const std::string& what);

/// --rounds and --seconds of a timing. The values passed are the defaults.
void add_samples(Arguments&, int& rounds, double& seconds, int fewest_rounds = 1);

/// --metric, whose value is the error, and --tolerance for costs.
void add_judgement(Arguments&, std::string& metric, double& tolerance);

/// --baselines: the folder of the baselines.
void add_baselines(Arguments&, std::string& folder);

/// --json, --csv and --markdown for an answer; also --all if it has `details` that people rarely
/// want.
void add_format(Arguments&, Format&, const char* details = nullptr);

/// --json, which prints `what` instead.
Argument& add_json(Arguments&, bool& json, const std::string& what);

/// Throws InputError with all errors in these solver texts.
void check_solvers(const std::vector<std::string>& texts);

/// Prints on stderr what was skipped in the files of these scenes, one line each.
void tell_remarks(const std::vector<std::string>& remarks);

/// Options that change a scene: [--dt] [--duration] [--fabric] [--set key=value ...].
class SceneChanges {
 public:
  void bind(Arguments&);
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
  void bind(Arguments&);
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
