#include "experiments/render/film/film.hpp"

#include <algorithm>
#include <mutex>
#include <optional>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/render/film/kept_film.hpp"
#include "experiments/render/film/recorded_runs.hpp"
#include "experiments/render/picture/figure.hpp"
#include "experiments/render/picture/media.hpp"
#include "experiments/report/answer/compared_solvers.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/json.hpp"
#include "experiments/system/run_all.hpp"
#include "experiments/system/text.hpp"

namespace taut {

namespace {

constexpr int kScenesAtATime = 2;
constexpr double kSeconds = 3;          ///< of a film
constexpr std::size_t kMostOthers = 3;  ///< who is filmed on a scene that no study ran

/// One scene to be filmed: who runs it and who does not.
struct Film {
  std::string scene, summary;
  RunRequest request;
  std::vector<report::Clip::Panel> panels;  ///< of the solvers, in the order of the request's
  std::vector<std::string> labels;          ///< theirs: "Bullet float"
  std::vector<std::pair<std::string, std::string>> refused;  ///< solver, why
  double speed = 1;
  bool studied = true, still = false;

  void add(const std::string& solver, const std::string& label, const std::string& key) {
    request.solvers.push_back(solver);
    panels.push_back({solver_name(solver), report::brief_settings(solver), key});
    labels.push_back(label);
  }
};

/// The cases at equal work: pictures show what the answer's tables have.
Film studied_film(const report::ComparedSolvers& compared, const report::QuotedScene& quoted) {
  Film film{.scene = quoted.question.scene};
  for (std::size_t i = 0; i < quoted.cases.size(); ++i) {
    const Record* one = quoted.cases[i];
    if (!one || film.request.solvers.size() == std::size_t{kMostPanels}) continue;
    if (one->status.kind == Status::Kind::unsupported) {
      film.refused.emplace_back(one->solver, one->status.reason);
      continue;
    }
    film.request.scene = one->spec.scene;
    film.request.overrides = one->spec.overrides;
    film.add(one->spec.solver, compared.all[i].label, one->key);
  }
  return film;
}

/// A thrown sheet is gone before anybody has seen it: it takes half a second to cross its own size,
/// at no less than an eighth of real time.
double watchable_speed(const Scene& scene) {
  double fastest = 0;
  for (const Vec3& v : scene.start.v) fastest = std::max(fastest, v.norm());
  for (const double speed : {1.0, 0.5, 0.25})
    if (fastest * 0.5 * speed <= extent(scene)) return speed;
  return 0.125;
}

Film other_film(const report::ComparedSolvers& compared, const OtherScene& other) {
  const Scene scene = load_scene(find_scene(other.name));
  Film film{.scene = scene.name, .summary = scene.summary, .studied = false, .still = other.still};
  film.speed = watchable_speed(scene);
  film.request.scene = other.name;
  if (scene.duration() > kSeconds)
    film.request.overrides.push_back("time.duration=" + std::to_string(kSeconds));
  for (const report::ComparedSolver& solver : compared.all) {
    const auto quoted = std::ranges::find_if(
        solver.cases, [&](const Record* r) { return report::work_of(*r) == solver.work; });
    if (quoted == solver.cases.end() || film.request.solvers.size() == kMostOthers) continue;
    const SolverChoice choice = parse_solver((*quoted)->spec.solver);
    const std::string why = join(choice.entry->unsupported(scene, choice.params), "; ");
    if (why.empty())
      film.add((*quoted)->spec.solver, solver.label, "");
    else
      film.refused.emplace_back(solver.name, why);
  }
  return film;
}

std::vector<Film> all_films(const report::ReportInput& input,
                            const std::vector<OtherScene>& others) {
  const report::ComparedSolvers compared = report::compared_solvers_of(input);
  std::vector<Film> films;
  for (const report::QuotedScene& quoted : compared.scenes)
    films.push_back(studied_film(compared, quoted));
  for (const OtherScene& other : others) {
    Film film = other_film(compared, other);
    if (std::ranges::find(films, film.scene, &Film::scene) == films.end())
      films.push_back(std::move(film));
  }
  std::erase_if(films, [](const Film& film) { return film.request.solvers.empty(); });
  return films;
}

MediaOptions options_of(const Film& film, std::size_t runs) {
  MediaOptions options;
  options.still = film.still;
  options.speed = film.speed;
  options.duration = kSeconds * film.speed;
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

/// As the model of a report has it.
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

/// Of all that its pictures depend on: cases, size, speed, the length of the beginning that is
/// shown, this program.
std::string key_of(const Film& film) {
  const MediaOptions options = options_of(film, film.request.solvers.size());
  std::string all = program_digest() + "\n" + film.scene + "\n" + join(film.labels, "\n");
  const auto add = [&](const auto&... values) { ((all += "\n" + std::to_string(values)), ...); };
  CaseMaker maker;
  for (const std::string& solver : film.request.solvers)
    all += "\n" + maker.make({film.request.scene, film.request.overrides, solver}).key;
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

/// The film that is kept, else a new one, which is kept; with the names by which this report calls
/// what is in it.
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
  return std::move(*kept);
}

}  // namespace

void film_scenes(report::ReportInput& input, const std::vector<OtherScene>& others,
                 const std::filesystem::path& folder,
                 const std::function<void(const std::string&)>& say) {
  const std::vector<Film> films = all_films(input, others);
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
  for (auto& result : results) {
    if (!result) continue;
    input.media.push_back(std::move(result->media));
    std::ranges::move(result->series, std::back_inserter(input.series));
  }
}

}  // namespace taut
