#include "experiments/render/film/film_plan.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/io/scene_io.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/render/film/film.hpp"
#include "experiments/render/picture/figure.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/questions/compared_solvers.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/system/data.hpp"

namespace taut {

namespace {

constexpr std::size_t kMostOthers = 3;  ///< solvers filmed on a scene that no study ran

/// A film, and what the page says beside it.
struct PlannedFilm {
  Film film;
  report::SceneMedia media;
  std::vector<std::string> labels;  ///< of the runs: "Bullet float"
  bool studied = true;

  /// Adds a run with the solver of this record. `key` is that of its case, "" on a scene that no
  /// study ran.
  void add(const Record& one, const std::string& label, const std::string& key) {
    film.request.solvers.push_back(one.spec.solver);
    media.panels.push_back({one.solver, report::brief_settings(one), key});
    labels.push_back(label);
  }
};

/// The cases at equal work: pictures show what the answer's tables have.
PlannedFilm of_studied(const report::ComparedSolvers& compared, const report::QuotedScene& quoted) {
  PlannedFilm planned;
  RunRequest& request = planned.film.request;
  planned.media.scene = quoted.task.scene;
  for (std::size_t i = 0; i < quoted.cases.size(); ++i) {
    const Record* one = quoted.cases[i];
    if (!one || request.solvers.size() == std::size_t{kMostPanels}) continue;
    if (one->status.kind == Status::Kind::unsupported) {
      planned.media.refused.emplace_back(one->solver, one->status.reason.text());
      continue;
    }
    request.scene = one->spec.scene;
    request.settings = one->spec.settings;
    planned.add(*one, compared.all[i].label, one->key);
  }
  return planned;
}

/// Speed of a film at which a thrown sheet can be watched: in half a second of video it moves by at
/// most the scene's extent, unless that takes less than an eighth of real time.
double watchable_speed(const Scene& scene) {
  double fastest = 0;
  for (const Vec3& v : scene.start.v) fastest = std::max(fastest, v.norm());
  for (const double speed : {1.0, 0.5, 0.25})
    if (fastest * 0.5 * speed <= extent(scene)) return speed;
  return 0.125;
}

PlannedFilm of_other(const report::ComparedSolvers& compared, const OtherScene& other) {
  const Scene scene = load_scene(find_scene(other.name));
  PlannedFilm planned{.media = {.scene = scene.name, .summary = scene.summary}, .studied = false};
  Film& film = planned.film;
  film.still = other.still;
  film.small = true;
  film.speed = watchable_speed(scene);
  film.request.scene = other.name;
  const double shown = kFilmSeconds * film.speed;
  if (scene.duration() > shown)
    film.request.settings.emplace_back("time.duration", shortest(kFilmSeconds));
  for (const report::ComparedSolver& solver : compared.all) {
    const auto quoted = std::ranges::find_if(
        solver.cases, [&](const Record* r) { return report::work_of(*r) == solver.work; });
    if (quoted == solver.cases.end() || film.request.solvers.size() == kMostOthers) continue;
    const SolverChoice choice = parse_solver((*quoted)->spec.solver);
    const std::string why = join(choice.entry->unsupported(scene, choice.params), "; ");
    if (why.empty())
      planned.add(**quoted, solver.label, "");
    else
      planned.media.refused.emplace_back(solver.name, why);
  }
  return planned;
}

std::vector<PlannedFilm> plan(const report::ReportInput& input,
                              const std::vector<OtherScene>& others) {
  const report::ComparedSolvers compared = report::compared_solvers_of(input);
  std::vector<PlannedFilm> all;
  for (const report::QuotedScene& quoted : compared.scenes)
    all.push_back(of_studied(compared, quoted));
  for (const OtherScene& other : others) {
    PlannedFilm planned = of_other(compared, other);
    const auto same = [&](const PlannedFilm& one) {
      return one.media.scene == planned.media.scene;
    };
    if (std::ranges::none_of(all, same)) all.push_back(std::move(planned));
  }
  std::erase_if(all, [](const PlannedFilm& one) { return one.film.request.solvers.empty(); });
  for (PlannedFilm& one : all)
    one.film.panels = static_cast<int>(one.media.panels.size() + one.media.refused.size());
  return all;
}

}  // namespace

void add_films(report::ReportInput& input, const std::vector<OtherScene>& others,
               const std::filesystem::path& folder,
               const std::function<void(const std::string&, std::size_t, std::size_t)>& tell) {
  std::vector<PlannedFilm> planned = plan(input, others);
  std::vector<Film> films;
  for (const PlannedFilm& one : planned) films.push_back(one.film);
  std::size_t done = 0;
  const auto made = [&](std::size_t k, const std::string& why) {
    const std::string news = films[k].still ? " drawn" : " filmed";
    tell(planned[k].media.scene + (why.empty() ? news : " not filmed: " + why), ++done,
         films.size());
  };
  std::vector<std::optional<FilmResult>> results = make_films(films, folder, made);
  for (std::size_t k = 0; k < planned.size(); ++k) {
    if (!results[k]) continue;
    report::SceneMedia& media = planned[k].media;
    for (std::size_t run = 0; !planned[k].studied && run < media.panels.size(); ++run)
      std::ranges::move(
          report::shown_series(
              results[k]->series[run],
              {media.scene, media.panels[run].solver, planned[k].labels[run], "", {}, {}}),
          std::back_inserter(input.series));
    media.footage = std::move(results[k]->footage);
    input.media.push_back(std::move(media));
  }
}

}  // namespace taut
