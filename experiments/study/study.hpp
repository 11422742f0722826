#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/document.hpp"
#include "core/model/scene_setting.hpp"
#include "experiments/case/case.hpp"

namespace taut {

/// A setting that a study varies: a scene key ("fabric", or with a dot as in "time.dt"), a
/// parameter of one solver ("xpbd:structural"), or a parameter of all solvers that have it.
struct StudyAxis {
  std::string name;
  std::vector<std::string> values;  ///< as typed: TOML for scene keys ("\"1/64\"", "[16, 16]")
  bool of_scene() const { return is_of_scene(name); }
  std::string solver() const {  ///< "" for all that have the parameter
    return of_solver() ? name.substr(0, name.find(':')) : "";
  }
  std::string parameter() const { return of_solver() ? name.substr(name.find(':') + 1) : name; }
  bool is_of(std::string_view a_solver) const { return !of_solver() || solver() == a_solver; }

 private:
  bool of_solver() const { return name.find(':') != std::string::npos; }
};

/// Cases that a study leaves out: those that match all named settings.
struct Exclusion {
  /// Excluded values by "scene" (as in Study::scenes), "solver" (the entry's name) or the name of
  /// an axis. A case matches if it has any of the values.
  std::map<std::string, std::vector<std::string>> when;
};

/// A picture that a study requests; experiments/report knows the kinds.
struct Plot {
  std::string kind;
  std::map<std::string, std::string> options;  ///< "x", "y", "title", ...; numbers in shortest form
  std::map<std::string, SourceLocation> places;  ///< places of "kind" and of the options
};

/// A question and the cases that answer it: scenes x solvers x axes. It is read from a file of
/// experiments/studies or of the user; experiments/studies/README.md describes every key.
struct Study {
  std::string name;      ///< file stem
  std::string question;  ///< one sentence
  std::filesystem::path file;
  std::string preset;                ///< the preset that was applied; "": none
  std::vector<std::string> presets;  ///< names of all its presets
  /// "name:key=value,...": name or path, and settings for it alone.
  std::vector<std::string> scenes;
  std::vector<std::string> solvers;  ///< "name:key=value,..."
  /// File of settings that a search chose for the solvers, scene by scene; "": none.
  std::filesystem::path searched;
  /// The settings in that file, by scene as in `scenes`; empty if there is no such file yet.
  std::map<std::string, std::vector<std::string>> chosen;
  SceneSettings settings;  ///< of the scene, in every case
  std::vector<StudyAxis> axes;
  std::vector<Exclusion> exclusions;
  std::vector<Plot> plots;
  /// `places`: where the file has `settings` and the values of scene axes, by setting.
  /// `scene_places`: where it has the texts of `scenes`, by text.
  std::map<std::string, SourceLocation> places, scene_places;
};

/// A key of a study file.
struct StudyKey {
  std::string_view name;   ///< "scenes"; for a key of a figure "plot.x"
  bool in_preset = false;  ///< whether a preset may have it
  std::string_view help;   ///< a line or two
};
std::vector<StudyKey> study_keys();

/// A row in a file of searched settings (Study::searched): a setting that was tried, and the errors
/// for which it is its solver's best on the scene.
struct SearchedSetting {
  std::string scene;  ///< as in Study::scenes
  std::string solver;
  double error = 0;          ///< value of the metric; NaN: none
  double cost = 0;           ///< CPU s per simulated s, measured over a few steps; NaN: none
  std::string refused = {};  ///< why it meets no target; "" if it may
  bool cheapest = false;     ///< whether it is the solver's cheapest, regardless of error
  /// Errors for which it is the solver's best without accelerators.
  std::vector<double> plain = {};
  std::vector<double> best = {};  ///< errors for which it is the solver's best with accelerators
  bool chosen() const { return cheapest || !plain.empty() || !best.empty(); }
};
/// Text of such a file: `heading` (comment lines), `missing` (sentences on what is absent), and the
/// rows.
std::string searched_toml(const std::string& heading, const std::vector<SearchedSetting>&,
                          const std::vector<std::string>& missing);
/// Throws InputError with all errors of the file.
std::vector<SearchedSetting> read_searched(const std::filesystem::path&);

/// Error of one of Study::scenes, placed where the study names the scene, since a setting has no
/// line of its own.
Diagnostic placed(const Study&, const std::string& scene, const Diagnostic& of_scene);

/// Reads a study by name or path and applies of_build() with given_build(). `preset` replaces the
/// keys that it contains; "" applies none. `solvers`, if not empty, replace the study's own, which
/// are then not even checked. Throws InputError with all errors at once, including those of its
/// scenes, or if the study has no such preset.
Study load_study(const std::string& name_or_path, const std::string& preset = "",
                 const std::vector<std::string>& solvers = {});
/// Name of a study, without reading its file. Throws InputError if there is no such study.
std::string study_name(const std::string& name_or_path);

/// The parts of one of Study::scenes.
struct StudyScene {
  std::string name;  ///< name or path
  SceneSettings settings;
};
/// Throws InputError unless a list of key=value follows the colon, with each key once.
StudyScene parse_study_scene(const std::string& text);

/// The study with these time steps ("1/64") instead of its own. Its name includes them, so that the
/// original study's plan stays stored. Without steps, the study is unchanged.
Study at_time_steps(Study, const std::vector<std::string>& steps);

/// The study with `build` as the name of its external programs' build ("": unchanged). Their
/// results are then addressed by that name rather than by a digest of their files. Throws
/// InputError as parse_solver() does.
Study of_build(Study, const std::string& build);

/// The cases of a study, with scenes as the outermost loop and without repetitions. Throws
/// InputError with the errors of all scenes, or if there are more than 100 000 cases.
std::vector<Case> cases_of(const Study&);
/// Visits these cases one after another and keeps none.
void each_case(const Study&, const std::function<void(Case&&)>& visit);

}  // namespace taut
