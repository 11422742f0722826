#include "experiments/render/film/film.hpp"

#include <algorithm>
#include <mutex>
#include <optional>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/case/case.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/render/film/kept_film.hpp"
#include "experiments/render/film/recorded_runs.hpp"
#include "experiments/render/picture/figure.hpp"
#include "experiments/render/picture/media.hpp"
#include "experiments/system/run_all.hpp"
#include "experiments/system/text.hpp"

namespace taut {

namespace {

constexpr int kScenesAtATime = 2;

MediaOptions options_of(const Film& film) {
  MediaOptions options;
  options.still = film.still;
  options.speed = film.speed;
  options.duration = kFilmSeconds * film.speed;
  const int runs = static_cast<int>(film.request.solvers.size());
  const int columns = PageLayout::columns_of(runs);
  const int rows = (runs + columns - 1) / columns;
  options.width = film.small ? 704 : 960;
  options.height = film.small ? 320 : 400;
  options.crf = film.small ? 30 : 28;
  options.quality = RenderQuality::draft();  // quads of three to eight pixels
  const int places = PageLayout::columns_of(std::clamp(film.panels, 2, 3));
  options.width = options.width / places * columns / 2 * 2;
  if (rows > 1) options.height = options.height / columns * 4 / 5 * rows / 2 * 2;
  return options;
}

report::ColourBar bar_of(const ColourScale& scale) {
  constexpr int kStops = 17;
  report::ColourBar bar{.title = scale.title(), .stops = {}, .ticks = {}};
  for (int k = 0; k < kStops; ++k) {
    const Rgb8 c = scale.map().at(static_cast<double>(k) / (kStops - 1));
    bar.stops.push_back(formatted("#%02X%02X%02X", c.r, c.g, c.b));
  }
  for (const double value : scale.ticks())
    bar.ticks.emplace_back(scale.position(value), scale.text(value));
  return bar;
}

report::Footage footage_of(const RunSet& set, const Media& media, double speed) {
  const std::string who = join(set.runs, " and ", [](const RecordedRun& run) {
    return run.title + " (" + run.settings + ")";
  });
  report::Footage footage;
  footage.alt = set.scene.name + ": " + who + (set.runs.size() > 1 ? " side by side" : "") +
                " from the left, coloured by " + media.scale.title() + ", full red at " +
                media.scale.text(media.scale.high) +
                "; cloth inside a collider is hatched, a run that ended early is framed in red";
  footage.type = media.mp4.empty() ? media.poster_type : "video/mp4";
  footage.bytes = media.mp4.empty() ? media.poster : media.mp4;
  footage.poster = media.poster;
  footage.poster_type = media.poster_type;
  footage.columns = PageLayout::columns_of(static_cast<int>(set.runs.size()));
  footage.duration = media.t.back();
  footage.speed = speed;
  footage.frame = media.t[1] - media.t[0];
  footage.poster_t = media.poster_t;
  footage.bar = bar_of(media.scale);
  return footage;
}

/// Digest of everything on which a film's pictures depend: cases, size, speed, how much of the
/// beginning is shown, this program.
std::string key_of(const Film& film) {
  const MediaOptions options = options_of(film);
  std::string all = program_digest() + "\n" + std::string(pictures()) + "\n" + film.request.scene;
  const auto add = [&](const auto&... values) { ((all += "\n" + shortest(values)), ...); };
  CaseMaker maker;
  for (const std::string& solver : film.request.solvers)
    all += "\n" + maker.make({film.request.scene, film.request.settings, solver}).key;
  add(options.width, options.height, options.duration, options.speed, options.fps, options.crf,
      film.still);
  return sha256(all);
}

FilmResult make_film(const Film& film) {
  RunSet set = record_runs(film.request, [](const std::string&) {});
  const Media media = render_media(set.scene, set.runs, options_of(film));
  return {footage_of(set, media, film.speed), std::move(set.series)};
}

}  // namespace

std::vector<std::optional<FilmResult>> make_films(
    const std::vector<Film>& films, const std::filesystem::path& folder,
    const std::function<void(std::size_t, const std::string&)>& made) {
  std::vector<std::optional<FilmResult>> results(films.size());
  std::mutex one_at_a_time;
  run_all(films.size(), kScenesAtATime, [&](std::size_t k) {
    std::string why;
    try {
      const std::filesystem::path file = folder / (key_of(films[k]) + ".json");
      results[k] = kept_film(file);
      if (results[k]) return;
      results[k] = make_film(films[k]);
      keep_film(file, *results[k]);
    } catch (const InputError& error) {
      results[k].reset();
      why = error.what();
    }
    const std::lock_guard lock(one_at_a_time);
    made(k, why);
  });
  return results;
}

}  // namespace taut
