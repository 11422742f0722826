#include "experiments/render/film/kept_film.hpp"

#include <cmath>

#include "core/model/input_error.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

constexpr const char* kSchema = "taut-film-3";

/// Beside the file of its numbers: KEY.mp4, KEY-poster.jpg.
std::filesystem::path picture_of(const std::filesystem::path& file, const char* what,
                                 const std::string& type) {
  const char* extension = type == "video/mp4" ? ".mp4" : type == "image/jpeg" ? ".jpg" : ".png";
  return file.parent_path() / (file.stem().string() + what + extension);
}

/// Throws InputError unless the picture has as many bytes as its film says.
std::string picture(const std::filesystem::path& file, const JsonReader& size) {
  std::string bytes = read_text(file);
  if (static_cast<double>(bytes.size()) != size.number())
    throw InputError(file.string() + " is damaged");
  return bytes;
}

FilmResult film_of(const JsonReader& json, const std::filesystem::path& file) {
  json.require_schema(kSchema);
  const auto number = [&](const char* name) { return json.at(name).number(); };
  FilmResult film;
  report::SceneMedia& media = film.media;
  media.duration = number("duration"), media.speed = number("speed");
  media.frame = number("frame"), media.poster = number("poster_t");
  report::Clip& clip = media.clip;
  clip.type = json.at("type").text(), clip.poster_type = json.at("poster_type").text();
  clip.bytes = picture(picture_of(file, "", clip.type), json.at("bytes"));
  clip.poster = picture(picture_of(file, "-poster", clip.poster_type), json.at("poster_bytes"));
  clip.alt = json.at("alt").text();
  media.bar = parse_json(json.at("bar").text());
  for (const JsonReader& one : json.at("series").items()) {
    report::TimeSeries& series = film.series.emplace_back();
    series.scene = one.at("scene").text(), series.solver = one.at("solver").text();
    series.label = one.at("label").text(), series.value = one.at("value").text();
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
            {"bytes", clip.bytes.size()},
            {"poster_bytes", clip.poster.size()},
            {"poster_type", clip.poster_type},
            {"alt", clip.alt},
            {"bar", to_text(media.bar)}};
  json["series"] = json_array(film.series, [](const report::TimeSeries& series) {
    return Json{{"scene", series.scene}, {"solver", series.solver},
                {"label", series.label}, {"value", series.value},
                {"t", series.t},         {"y", json_array(series.y, json_number)}};
  });
  make_folder(file.parent_path());
  write_file(picture_of(file, "", clip.type), clip.bytes);
  write_file(picture_of(file, "-poster", clip.poster_type), clip.poster);
  write_file(file, to_text(json));  // the last: a film without it is none
}

std::optional<FilmResult> kept_film(const std::filesystem::path& file) try {
  if (!std::filesystem::exists(file)) return std::nullopt;
  return read_json(read_text(file), file.string(),
                   [&](const JsonReader& json) { return film_of(json, file); });
} catch (const InputError&) {
  return std::nullopt;
}

}  // namespace taut
