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

/// A film of every scene that a study ran: each contender under the settings at which single cases
/// are quoted, in the order of the report, beside the reason of whoever refuses the scene. Those of
/// `others` are smaller, or pictures. Throws InputError if one of the others is no scene.
std::vector<Film> films_of(const report::ComparedSolvers&, const std::vector<OtherScene>& others);

/// Their videos and posters and, of scenes that no study ran, strain over time; two scenes at a
/// time. A film is kept in `folder` under a key of all that it depends on, and made once. `say` is
/// told, from any thread but one at a time, which scene was made. A scene that cannot be drawn is
/// left out and `say` is told why; so it is with all of them where there is no renderer.
std::vector<FilmResult> make_films(const std::vector<Film>&, const std::filesystem::path& folder,
                                   const std::function<void(const std::string&)>& say);

}  // namespace taut
