#pragma once

#include <filesystem>
#include <optional>

#include "experiments/render/film/film.hpp"

namespace taut {

/// Keeps pictures, numbers and series: KEY.json, and beside it KEY.mp4 and KEY-poster.jpg (.png
/// without ffmpeg). Throws InputError if the disk refuses.
void keep_film(const std::filesystem::path& file, const FilmResult&);

/// What keep_film() wrote; nothing if it did not, or if a file is damaged: it is made again.
std::optional<FilmResult> kept_film(const std::filesystem::path& file);

}  // namespace taut
