#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/render/film/recorded_runs.hpp"
#include "experiments/report/footage.hpp"

namespace taut {

inline constexpr double kFilmSeconds = 3;  ///< of video

/// A film to be made: the beginning of a scene.
struct Film {
  RunRequest request;
  double speed = 1;    ///< simulated seconds per second of video
  int panels = 1;      ///< panels of the page: those of the runs and of solvers that refuse
  bool small = false;  ///< of smaller width and height
  bool still = false;  ///< a picture is enough
};

/// A finished film, and the values of each run over time.
struct FilmResult {
  report::Footage footage;
  std::vector<Series> series;
};

/// Makes videos and posters, two scenes at a time. A film is made once and kept in `folder` under a
/// key of all that it depends on. A film that cannot be drawn has no result; without a renderer
/// none has. Calls `made` for each film that was not kept before, with its index and the reason why
/// it is missing, "" if it is not. The calls come from any thread, one at a time.
std::vector<std::optional<FilmResult>> make_films(
    const std::vector<Film>&, const std::filesystem::path& folder,
    const std::function<void(std::size_t film, const std::string& why)>& made);

}  // namespace taut
