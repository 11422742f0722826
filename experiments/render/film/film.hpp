#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/render/film/kept_film.hpp"
#include "experiments/render/film/recorded_runs.hpp"
#include "experiments/report/input.hpp"
#include "experiments/report/questions/compared_solvers.hpp"

namespace taut {

inline constexpr double kFilmSeconds = 3;

/// A scene that no study ran.
struct OtherScene {
  std::string name;    ///< or path
  bool still = false;  ///< its poster is enough
};

/// One scene to be filmed: who runs it and who does not.
struct Film {
  std::string scene, summary;
  RunRequest request;
  std::vector<report::Clip::Panel> panels;  ///< of the solvers, in the order of the request's
  std::vector<std::string> labels;          ///< theirs: "Bullet float"
  std::vector<std::pair<std::string, std::string>> refused;  ///< solver, why
  double speed = 1;
  bool studied = true, still = false;

  /// One more who runs it; `key` of its case, "" of a scene that no study ran.
  void add(const std::string& solver, const std::string& label, const std::string& key);
};

/// A film of every scene that a study ran, in the order of the report: each contender at the
/// settings at which single cases are quoted, and the reasons of solvers that refuse the scene. The
/// films of `others` are smaller, or pictures. Throws InputError if one of the others is no scene.
std::vector<Film> films_of(const report::ComparedSolvers&, const std::vector<OtherScene>& others);

/// Makes their videos and posters, two scenes at a time, and strain over time for scenes that no
/// study ran. A film is made once and kept in `folder` under a key of all that it depends on. Calls
/// `say` with each scene that was made, and with the reason for each that cannot be drawn (all of
/// them, if there is no renderer) and is left out; from any thread, but one at a time.
std::vector<FilmResult> make_films(const std::vector<Film>&, const std::filesystem::path& folder,
                                   const std::function<void(const std::string&)>& say);

}  // namespace taut
