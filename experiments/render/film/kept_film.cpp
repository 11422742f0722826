#include "experiments/render/film/kept_film.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include "core/model/input_error.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut {

namespace {

constexpr const char* kSchema = "taut-film-2";

/// Of what report::base64() wrote.
std::string from_base64(const std::string& text) {
  static const auto kValues = [] {
    std::array<int, 256> values{};
    values.fill(-1);
    int next = 0;
    for (const char c :
         std::string("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"))
      values[static_cast<unsigned char>(c)] = next++;
    return values;
  }();
  std::string bytes;
  bytes.reserve(text.size() * 3 / 4);
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const int value = kValues[static_cast<unsigned char>(c)];
    if (value < 0) break;
    bits = bits << 6 | static_cast<std::uint32_t>(value), held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes += static_cast<char>(bits >> held & 0xFF);
  }
  return bytes;
}

std::string bytes_of(const JsonReader& json, const char* name) {
  return from_base64(json.at(name).text());
}

FilmResult film_of(const JsonReader& json) {
  json.require_schema(kSchema);
  const auto number = [&](const char* name) { return json.at(name).number(); };
  FilmResult film;
  report::SceneMedia& media = film.media;
  media.duration = number("duration"), media.speed = number("speed");
  media.frame = number("frame"), media.poster = number("poster_t");
  media.clip = {.type = json.at("type").text(),
                .bytes = bytes_of(json, "bytes"),
                .poster = bytes_of(json, "poster"),
                .poster_type = json.at("poster_type").text(),
                .alt = json.at("alt").text(),
                .panels = {}};
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
            {"bytes", report::base64(clip.bytes)},
            {"poster", report::base64(clip.poster)},
            {"poster_type", clip.poster_type},
            {"alt", clip.alt},
            {"bar", to_text(media.bar)}};
  json["series"] = json_array(film.series, [](const report::TimeSeries& series) {
    return Json{{"scene", series.scene}, {"solver", series.solver},
                {"label", series.label}, {"value", series.value},
                {"t", series.t},         {"y", json_array(series.y, json_number)}};
  });
  make_folder(file.parent_path());
  write_file(file, to_text(json));
}

std::optional<FilmResult> kept_film(const std::filesystem::path& file) try {
  if (!std::filesystem::exists(file)) return std::nullopt;
  return read_json(read_text(file), file.string(),
                   [](const JsonReader& json) { return film_of(json); });
} catch (const InputError&) {
  return std::nullopt;
}

}  // namespace taut
