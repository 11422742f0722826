#include "experiments/render/film/kept_film.hpp"

#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

constexpr const char* kSchema = "taut-film-5";

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
  FilmResult film;
  report::Footage& footage = film.footage;
  footage.duration = json.at("duration").number();
  footage.speed = json.at("speed").number();
  footage.frame = json.at("frame").number();
  footage.poster_t = json.at("poster_t").number();
  footage.columns = json.at("columns").integer();
  footage.type = json.at("type").text();
  footage.poster_type = json.at("poster_type").text();
  footage.bytes = picture(picture_of(file, "", footage.type), json.at("digest_of_film"));
  footage.poster =
      picture(picture_of(file, "-poster", footage.poster_type), json.at("digest_of_poster"));
  footage.alt = json.at("alt").text();
  const JsonReader bar = json.at("bar");
  footage.bar.title = bar.at("title").text();
  for (const JsonReader& stop : bar.at("stops").items()) footage.bar.stops.push_back(stop.text());
  for (const JsonReader& tick : bar.at("ticks").items())
    footage.bar.ticks.emplace_back(tick.at("at").number(), tick.at("text").text());
  for (const JsonReader& table : json.at("series").items())
    film.series.push_back(series_from_json(table.text(), file.string()));
  return film;
}

}  // namespace

void keep_film(const std::filesystem::path& file, const FilmResult& film) {
  const report::Footage& footage = film.footage;
  const report::ColourBar& bar = footage.bar;
  Json json{{"schema", kSchema},
            {"duration", footage.duration},
            {"speed", footage.speed},
            {"frame", footage.frame},
            {"poster_t", footage.poster_t},
            {"columns", footage.columns},
            {"type", footage.type},
            {"digest_of_film", sha256(footage.bytes)},
            {"digest_of_poster", sha256(footage.poster)},
            {"poster_type", footage.poster_type},
            {"alt", footage.alt}};
  json["bar"] = {{"title", bar.title}, {"stops", bar.stops}};
  json["bar"]["ticks"] = json_array(bar.ticks, [](const auto& tick) {
    return Json{{"at", tick.first}, {"text", tick.second}};
  });
  json["series"] = json_array(film.series, [](const Series& table) { return to_json(table); });
  make_folder(file.parent_path());
  json["digest"] = digest_of(json);
  write_regular(picture_of(file, "", footage.type), footage.bytes);
  write_regular(picture_of(file, "-poster", footage.poster_type), footage.poster);
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
