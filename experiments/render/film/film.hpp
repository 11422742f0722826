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

/// What is to be filmed: the beginning of a scene.
struct Film {
  RunRequest request;
  double speed = 1;    ///< simulated seconds per second of video
  int panels = 1;      ///< panels of the page: those of the runs and of solvers that refuse
  bool small = false;  ///< less wide and high
  bool still = false;  ///< a picture is enough
};

/// What was filmed, and the values of each run over time.
struct FilmResult {
  report::Footage footage;
  std::vector<Series> series;
};

/// Makes videos and posters, two scenes at a time. A film is made once and kept in `folder` under a
/// key of all that it depends on. The result lacks a film that cannot be drawn; without a renderer
/// it lacks all. Calls `made` for each film that was not kept before, with its index and with the
/// reason if it is missing, else "". The calls come from any thread, one at a time.
std::vector<std::optional<FilmResult>> make_films(
    const std::vector<Film>&, const std::filesystem::path& folder,
    const std::function<void(std::size_t film, const std::string& why)>& made);

}  // namespace taut
