#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "experiments/report/input.hpp"

namespace taut {

/// What a report has of a film.
struct FilmResult {
  report::SceneMedia media;                ///< with one clip
  std::vector<report::TimeSeries> series;  ///< of a scene that no study ran
};

/// Keeps pictures, numbers and series; not the names by which a report calls them: KEY.json, and
/// beside it KEY.mp4 and KEY-poster.jpg (.png without ffmpeg). Throws InputError if the disk
/// refuses.
void keep_film(const std::filesystem::path& file, const FilmResult&);

/// What keep_film() wrote; nothing if it did not, or if a file is damaged: it is made again.
std::optional<FilmResult> kept_film(const std::filesystem::path& file);

}  // namespace taut
