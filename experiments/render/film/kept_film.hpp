#pragma once

#include <filesystem>
#include <optional>

#include "experiments/render/film/film.hpp"

namespace taut {

/// Keeps pictures, numbers and series: KEY.json, and beside it KEY.mp4 and KEY-poster.jpg (.png
/// without ffmpeg). Throws InputError if the disk refuses.
void keep_film(const std::filesystem::path& file, const FilmResult&);

/// The film that keep_film() wrote. Nothing if there is none, or if a file is damaged, so that the
/// film is made again.
std::optional<FilmResult> kept_film(const std::filesystem::path& file);

}  // namespace taut
