#include <algorithm>

#include "core/io/scene_io.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/render/film/film.hpp"
#include "experiments/render/picture/figure.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/system/data.hpp"

namespace taut {

namespace {

constexpr std::size_t kMostOthers = 3;  ///< who is filmed on a scene that no study ran

/// The cases at equal work: pictures show what the answer's tables have.
Film studied_film(const report::ComparedSolvers& compared, const report::QuotedScene& quoted) {
  Film film{.scene = quoted.task.scene};
  for (std::size_t i = 0; i < quoted.cases.size(); ++i) {
    const Record* one = quoted.cases[i];
    if (!one || film.request.solvers.size() == std::size_t{kMostPanels}) continue;
    if (one->status.kind == Status::Kind::unsupported) {
      film.refused.emplace_back(one->solver, one->status.reason);
      continue;
    }
    film.request.scene = one->spec.scene;
    film.request.settings = one->spec.settings;
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
  if (scene.duration() > kFilmSeconds)
    film.request.settings.emplace_back("time.duration", std::to_string(kFilmSeconds));
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

}  // namespace

void Film::add(const std::string& solver, const std::string& label, const std::string& key) {
  request.solvers.push_back(solver);
  panels.push_back({solver_name(solver), report::brief_settings(solver), key});
  labels.push_back(label);
}

std::vector<Film> films_of(const report::ComparedSolvers& compared,
                           const std::vector<OtherScene>& others) {
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

}  // namespace taut
