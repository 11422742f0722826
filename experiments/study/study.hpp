#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/document.hpp"
#include "experiments/case/case.hpp"

namespace taut {

/// A setting that a study varies: a scene key ("fabric", or with a dot as "time.dt"), a parameter
/// of one solver ("xpbd:structural"), or a parameter of all that have it.
struct StudyAxis {
  std::string name;
  std::vector<std::string> values;  ///< as typed: TOML for scene keys ("\"1/64\"", "[16, 16]")
  bool of_scene() const { return name == "fabric" || name.find('.') != std::string::npos; }
  std::string solver() const {  ///< "": all that have the parameter
    return of_solver() ? name.substr(0, name.find(':')) : "";
  }
  std::string parameter() const { return of_solver() ? name.substr(name.find(':') + 1) : name; }
  bool is_of(std::string_view a_solver) const { return !of_solver() || solver() == a_solver; }

 private:
  bool of_solver() const { return name.find(':') != std::string::npos; }
};

/// Cases that a study leaves out: those that match all of the named settings.
struct Exclusion {
  /// By "scene" (as in Study::scenes), "solver" (entry's name) or an axis's name: any of these
  /// values.
  std::map<std::string, std::vector<std::string>> when;
};

/// A picture that a study asks for; experiments/report knows the kinds.
struct Plot {
  std::string kind;
  std::map<std::string, std::string> options;  ///< "x", "y", "title", ...: numbers in shortest form
  std::map<std::string, SourceLocation> places;  ///< of "kind" and of the options
};

/// A question and the cases that answer it: scenes x solvers x axes. A file of
/// experiments/studies or of the user; experiments/studies/README.md describes every key.
struct Study {
  std::string name;      ///< file stem
  std::string question;  ///< one sentence
  std::filesystem::path file;
  std::string preset;                ///< which was applied; "": none
  std::vector<std::string> presets;  ///< names of those it has
  std::vector<std::string> scenes;   ///< "name:key=value,...": name or path, settings of it alone
  std::vector<std::string> solvers;  ///< "name:key=value,..."
  /// The file of settings that a search chose for the solvers, scene by scene; "": none.
  std::filesystem::path searched;
  /// What stands there, by the scene as in `scenes`; empty: there is no such file yet.
  std::map<std::string, std::vector<std::string>> chosen;
  SceneSettings settings;  ///< of the scene, in every case
  std::vector<StudyAxis> axes;
  std::vector<Exclusion> exclusions;
  std::vector<Plot> plots;
  /// Where the file says what stands in `settings` and in the axes of scenes, by the setting, and
  /// what stands in `scenes`, by its text.
  std::map<std::string, SourceLocation> places, scene_places;
};

/// A key of a study file.
struct StudyKey {
  std::string_view name;   ///< "scenes"; of a figure "plot.x"
  bool in_preset = false;  ///< a preset may have it
  std::string_view help;   ///< a line or two
};
std::vector<StudyKey> study_keys();

/// A row of a file of searched settings (Study::searched): a setting that was tried, and for what
/// it is its solver's best on the scene, if for anything.
struct SearchedSetting {
  std::string scene;  ///< as in Study::scenes
  std::string solver;
  double error = 0;          ///< of the metric; NaN: none
  double cost = 0;           ///< CPU s per simulated s, by a few steps; NaN: none
  std::string refused = {};  ///< why it meets no target; "": it may
  bool cheapest = false;     ///< of the solver's settings, whatever the error
  std::vector<double> plain =
      {};                         ///< errors for which it is the solver's best without accelerators
  std::vector<double> best = {};  ///< errors for which it is the solver's best with them
  bool chosen() const { return cheapest || !plain.empty() || !best.empty(); }
};
/// The text of such a file: `heading` (comment lines), the rows, and as comments the sentences of
/// `missing` on who is absent.
std::string searched_toml(const std::string& heading, const std::vector<SearchedSetting>&,
                          const std::vector<std::string>& missing);
/// Throws InputError with all that is wrong with the file.
std::vector<SearchedSetting> read_searched(const std::filesystem::path&);

/// What is wrong with one of Study::scenes, at the place where the study says it: a setting has
/// no line of its own.
Diagnostic placed(const Study&, const std::string& scene, const Diagnostic& of_scene);

/// Reads a study by name or path, of_build() given_build(); `preset` replaces what it names, ""
/// nothing; `solvers` stand in place of its own, which are not looked at. Throws InputError with
/// every diagnostic at once, those of its scenes too, or if the study has no such preset.
Study load_study(const std::string& name_or_path, const std::string& preset = "",
                 const std::vector<std::string>& solvers = {});
/// Its name, without reading it. Throws InputError: there is no such study.
std::string study_name(const std::string& name_or_path);

/// One of Study::scenes, in its parts.
struct StudyScene {
  std::string name;  ///< or path
  SceneSettings settings;
};
/// Throws InputError if what follows the colon is no list of key=value, each key once.
StudyScene parse_study_scene(const std::string& text);

/// The study at these time steps ("1/64") in place of its own, under a name that says so, so that
/// its own results stay as planned. Without steps: the study unchanged.
Study at_time_steps(Study, const std::vector<std::string>& steps);

/// The study with its external programs called a build of this name ("": as they are): their
/// results are addressed by it, in place of what is known of their files. Throws InputError as
/// parse_solver() does.
Study of_build(Study, const std::string& build);

/// The cases of a study, scenes outermost, without repetitions. Throws InputError with what is
/// wrong with any of the scenes, or if it would be more than 100 000.
std::vector<Case> cases_of(const Study&);
/// The same, one after the other: none is held.
void each_case(const Study&, const std::function<void(Case&&)>& visit);

}  // namespace taut
