#include "experiments/render/film/kept_film.hpp"

#include <cmath>

#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

constexpr const char* kSchema = "taut-film-4";

/// Beside the file of its numbers: KEY.mp4, KEY-poster.jpg.
std::filesystem::path picture_of(const std::filesystem::path& file, const char* what,
                                 const std::string& type) {
  const char* extension = type == "video/mp4" ? ".mp4" : type == "image/jpeg" ? ".jpg" : ".png";
  return file.parent_path() / (file.stem().string() + what + extension);
}

/// Throws InputError unless the picture has the bytes that its film was kept with.
std::string picture(const std::filesystem::path& file, const JsonReader& digest) {
  std::string bytes = read_text(file);
  if (sha256(bytes) != digest.text()) throw InputError(file.string() + " is damaged");
  return bytes;
}

/// Over what is a file or can go: a pipe would be waited for.
void write_regular(const std::filesystem::path& file, const std::string& bytes) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) std::filesystem::remove(file, none);
  if (std::filesystem::exists(file, none) && !std::filesystem::is_regular_file(file, none))
    throw InputError(file.string() + ": is not a regular file");
  write_file(file, bytes);
}

/// Of all numbers and names of a film, which are a file beside its pictures.
std::string digest_of(Json numbers) {
  numbers.erase("digest");
  return sha256(to_text(numbers));
}

FilmResult film_of(const JsonReader& json, const std::filesystem::path& file) {
  json.require_schema(kSchema);
  const auto number = [&](const char* name) { return json.at(name).number(); };
  FilmResult film;
  report::SceneMedia& media = film.media;
  media.duration = number("duration");
  media.speed = number("speed");
  media.frame = number("frame");
  media.poster = number("poster_t");
  report::Clip& clip = media.clip;
  clip.type = json.at("type").text();
  clip.poster_type = json.at("poster_type").text();
  clip.bytes = picture(picture_of(file, "", clip.type), json.at("bytes"));
  clip.poster = picture(picture_of(file, "-poster", clip.poster_type), json.at("poster_bytes"));
  clip.alt = json.at("alt").text();
  media.bar = parse_json(json.at("bar").text());
  for (const JsonReader& one : json.at("series").items()) {
    report::TimeSeries& series = film.series.emplace_back();
    series.scene = one.at("scene").text();
    series.solver = one.at("solver").text();
    series.label = one.at("label").text();
    series.value = one.at("value").text();
    series.t = one.at("t").numbers();
    for (const JsonReader& y : one.at("y").items()) series.y.push_back(y.number_or_null());
  }
  return film;
}

}  // namespace

void keep_film(const std::filesystem::path& file, const FilmResult& film) {
  const report::SceneMedia& media = film.media;
  const report::Clip& clip = media.clip;
  Json json{{"schema", kSchema},
            {"duration", media.duration},
            {"speed", media.speed},
            {"frame", media.frame},
            {"poster_t", media.poster},
            {"type", clip.type},
            {"bytes", sha256(clip.bytes)},
            {"poster_bytes", sha256(clip.poster)},
            {"poster_type", clip.poster_type},
            {"alt", clip.alt},
            {"bar", to_text(media.bar)}};
  json["series"] = json_array(film.series, [](const report::TimeSeries& series) {
    return Json{{"scene", series.scene}, {"solver", series.solver},
                {"label", series.label}, {"value", series.value},
                {"t", series.t},         {"y", json_array(series.y, json_number)}};
  });
  make_folder(file.parent_path());
  json["digest"] = digest_of(json);
  write_regular(picture_of(file, "", clip.type), clip.bytes);
  write_regular(picture_of(file, "-poster", clip.poster_type), clip.poster);
  write_regular(file, to_text(json));  // the last: without it there is no film
}

std::optional<FilmResult> kept_film(const std::filesystem::path& file) try {
  if (!std::filesystem::exists(file)) return std::nullopt;
  const std::string text = read_text(file);
  return read_json(text, file.string(), [&](const JsonReader& json) {
    if (json.at("digest").text() != digest_of(parse_json(text)))
      throw InputError(file.string() + " is damaged");
    return film_of(json, file);
  });
} catch (const InputError&) {
  return std::nullopt;
}

}  // namespace taut
