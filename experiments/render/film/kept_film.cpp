#include "experiments/render/film/kept_film.hpp"

#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

constexpr const char* kSchema = "taut-film-5";

using report::ColourBar, report::Footage;
/// What is kept as JSON; pictures are files, and ticks are pairs.
constexpr std::tuple kFootage{
    Field{"type", &Footage::type},         Field{"poster_type", &Footage::poster_type},
    Field{"alt", &Footage::alt},           Field{"columns", &Footage::columns},
    Field{"duration", &Footage::duration}, Field{"speed", &Footage::speed},
    Field{"frame", &Footage::frame},       Field{"poster_t", &Footage::poster_t}};
constexpr std::tuple kBar{Field{"title", &ColourBar::title}, Field{"stops", &ColourBar::stops}};

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

/// Writes the file, over a regular file only; anything else is removed first or refused, because
/// writing to a pipe would wait for its reader.
void write_regular(const std::filesystem::path& file, const std::string& bytes) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) std::filesystem::remove(file, none);
  if (std::filesystem::exists(file, none) && !std::filesystem::is_regular_file(file, none))
    throw InputError(file.string() + ": is not a regular file");
  write_file(file, bytes);
}

/// Digest of all numbers and names of a film, which are kept in a file beside its pictures.
std::string digest_of(Json numbers) {
  numbers.erase("digest");
  return sha256(to_text(numbers));
}

FilmResult film_of(const JsonReader& json, const std::filesystem::path& file) {
  json.require_schema(kSchema);
  FilmResult film;
  Footage& footage = film.footage;
  read_into(json, footage, kFootage);
  footage.bytes = picture(picture_of(file, "", footage.type), json.at("digest_of_film"));
  footage.poster =
      picture(picture_of(file, "-poster", footage.poster_type), json.at("digest_of_poster"));
  const JsonReader bar = json.at("bar");
  read_into(bar, footage.bar, kBar);
  for (const JsonReader& tick : bar.at("ticks").items())
    footage.bar.ticks.emplace_back(tick.at("at").number(), tick.at("text").text());
  for (const JsonReader& table : json.at("series").items())
    film.series.push_back(series_from_json(table.text(), file.string()));
  return film;
}

}  // namespace

void keep_film(const std::filesystem::path& file, const FilmResult& film) {
  const Footage& footage = film.footage;
  const ColourBar& bar = footage.bar;
  Json json = json_of(footage, kFootage);
  json["schema"] = kSchema;
  json["digest_of_film"] = sha256(footage.bytes);
  json["digest_of_poster"] = sha256(footage.poster);
  json["bar"] = json_of(bar, kBar);
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
