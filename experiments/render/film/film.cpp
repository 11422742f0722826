#include "experiments/render/film/film.hpp"

#include <algorithm>
#include <iterator>
#include <mutex>
#include <optional>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/case/fingerprint.hpp"
#include "experiments/render/film/kept_film.hpp"
#include "experiments/render/film/recorded_runs.hpp"
#include "experiments/render/picture/figure.hpp"
#include "experiments/render/picture/media.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/system/json.hpp"
#include "experiments/system/run_all.hpp"
#include "experiments/system/text.hpp"

namespace taut {

namespace {

constexpr int kScenesAtATime = 2;

MediaOptions options_of(const Film& film, std::size_t runs) {
  MediaOptions options;
  options.still = film.still;
  options.speed = film.speed;
  options.duration = kFilmSeconds * film.speed;
  const int panels = std::max(2, static_cast<int>(runs + film.refused.size()));
  const int columns = PageLayout::columns_of(static_cast<int>(runs));
  const int rows = (static_cast<int>(runs) + columns - 1) / columns;
  options.width = film.studied ? 960 : 704;
  options.height = film.studied ? 400 : 320;
  options.crf = film.studied ? 28 : 30;
  options.quality = RenderQuality::draft();  // quads of three to eight pixels
  options.width = options.width / PageLayout::columns_of(std::min(panels, 3)) * columns / 2 * 2;
  if (rows > 1) options.height = options.width / columns * 4 / 5 * rows / 2 * 2;
  return options;
}

/// The field `bar` of a film (MODEL.md, Films).
Json bar_of(const ColourScale& scale) {
  constexpr int kStops = 17;
  Json bar{{"title", scale.title()}};
  for (int k = 0; k < kStops; ++k) {
    const Rgb8 c = scale.map().at(static_cast<double>(k) / (kStops - 1));
    bar["stops"].push_back(formatted("#%02X%02X%02X", c.r, c.g, c.b));
  }
  for (const double value : scale.ticks())
    bar["ticks"].push_back({{"at", scale.position(value)}, {"text", scale.text(value)}});
  return bar;
}

report::Clip clip_of(const RunSet& set, const Media& media) {
  report::Clip clip;
  const std::string who = join(set.runs, " and ", [](const RecordedRun& run) {
    return run.title + " (" + run.settings + ")";
  });
  clip.alt = set.scene.name + ": " + who + (set.runs.size() > 1 ? " side by side" : "") +
             " from the left, coloured by " + media.scale.title() + ", full red at " +
             media.scale.text(media.scale.high) +
             "; cloth inside a collider is hatched, a run that ended early is framed in red";
  clip.type = media.mp4.empty() ? media.poster_type : "video/mp4";
  clip.bytes = media.mp4.empty() ? media.poster : media.mp4;
  clip.poster = media.poster;
  clip.poster_type = media.poster_type;
  return clip;
}

/// The digest of all that its pictures depend on: cases, size, speed, how much of the beginning is
/// shown, this program.
std::string key_of(const Film& film) {
  const MediaOptions options = options_of(film, film.request.solvers.size());
  std::string all = program_digest() + "\n" + std::string(pictures()) + "\n" + film.scene + "\n" +
                    join(film.labels, "\n");
  const auto add = [&](const auto&... values) { ((all += "\n" + std::to_string(values)), ...); };
  CaseMaker maker;
  for (const std::string& solver : film.request.solvers)
    all += "\n" + maker.make({film.request.scene, film.request.settings, solver}).key;
  add(options.width, options.height, options.duration, options.speed, options.fps, options.crf,
      film.studied, film.still);
  return sha256(all);
}

FilmResult make_film(const Film& film) {
  const RunSet set = record_runs(film.request, [](const std::string&) {});
  const Media media = render_media(set.scene, set.runs, options_of(film, set.runs.size()));
  FilmResult result{{.clip = clip_of(set, media),
                     .duration = media.t.back(),
                     .speed = film.speed,
                     .bar = bar_of(media.scale),
                     .frame = media.t[1] - media.t[0],
                     .poster = media.poster_t},
                    {}};
  for (std::size_t k = 0; !film.studied && k < set.runs.size(); ++k)
    std::ranges::move(
        report::shown_series(
            set.series[k],
            {film.scene, solver_name(set.runs[k].trajectory.solver), film.labels[k], "", {}, {}}),
        std::back_inserter(result.series));
  return result;
}

/// Returns the kept film, or makes one and keeps it; then sets the labels of this report.
FilmResult kept_or_made(const Film& film, const std::filesystem::path& folder, bool& made) {
  const std::filesystem::path file = folder / (key_of(film) + ".json");
  std::optional<FilmResult> kept = kept_film(file);
  made = !kept;
  if (!kept) keep_film(file, kept.emplace(make_film(film)));
  report::SceneMedia& media = kept->media;
  media.scene = film.scene;
  media.summary = film.summary;
  media.refused = film.refused;
  media.clip.panels = film.panels;
  media.clip.columns = PageLayout::columns_of(static_cast<int>(film.panels.size()));
  return std::move(*kept);
}

}  // namespace

std::vector<FilmResult> make_films(const std::vector<Film>& films,
                                   const std::filesystem::path& folder,
                                   const std::function<void(const std::string&)>& say) {
  std::vector<std::optional<FilmResult>> results(films.size());
  std::mutex output;
  run_all(films.size(), kScenesAtATime, [&](std::size_t k) {
    std::string news = films[k].scene + (films[k].still ? " drawn" : " filmed");
    bool made = true;
    try {
      results[k] = kept_or_made(films[k], folder, made);
    } catch (const InputError& error) {
      news = films[k].scene + " not filmed: " + error.what();
    }
    const std::lock_guard lock(output);
    if (made) say(news);
  });
  std::vector<FilmResult> made;
  for (auto& result : results)
    if (result) made.push_back(std::move(*result));
  return made;
}

}  // namespace taut
