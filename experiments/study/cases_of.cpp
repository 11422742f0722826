// Expands a study into its cases.
#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/study/study.hpp"

namespace taut {

namespace {

/// Settings of one case, by axis name.
using Settings = std::map<std::string, std::string>;

/// Calls `visit` for every combination of one value per axis, the first axis outermost.
void combinations(const std::vector<StudyAxis>& axes,
                  const std::function<void(const Settings&)>& visit, Settings settings = {}) {
  const std::size_t next = settings.size();
  if (next == axes.size()) return visit(settings);
  for (const std::string& value : axes[next].values) {
    settings[axes[next].name] = value;
    combinations(axes, visit, settings);
  }
}

std::vector<StudyAxis> scene_axes(const Study& study) {
  std::vector<StudyAxis> chosen;
  std::ranges::copy_if(study.axes, std::back_inserter(chosen), &StudyAxis::of_scene);
  return chosen;
}

/// The axes that vary a solver's parameters: those that it has and that its text does not fix. An
/// axis of this solver alone replaces the general axis of the same parameter.
std::vector<StudyAxis> solver_axes(const Study& study, const std::string& text) {
  const SolverChoice choice = parse_solver(text);
  std::vector<StudyAxis> chosen;
  for (const StudyAxis& axis : study.axes) {
    const std::string name = axis.parameter();
    const bool has = axis.is_of(choice.entry->name) &&
                     std::ranges::count(choice.entry->params, name, &ParamSpec::name) > 0;
    const std::string own = std::string(choice.entry->name) + ":" + axis.name;
    const bool replaced = std::ranges::find(study.axes, own, &StudyAxis::name) != study.axes.end();
    if (has && !choice.params.given(name) && !replaced) chosen.push_back(axis);
  }
  return chosen;
}

/// Most cases of a study: more would take too long for anyone, so they are a mistake, such as an
/// axis with a thousand values too many.
constexpr int kMostCases = 100'000;

double count(const std::vector<StudyAxis>& axes) {
  double product = 1;
  for (const StudyAxis& axis : axes) product *= static_cast<double>(axis.values.size());
  return product;
}

/// Throws before any case is made if there are too many. Counts exclusions and repetitions too.
void require_few(const Study& study) {
  double of_solvers = 0;
  for (const std::string& solver : study.solvers) of_solvers += count(solver_axes(study, solver));
  const double all =
      static_cast<double>(study.scenes.size()) * count(scene_axes(study)) * of_solvers;
  if (all > kMostCases)
    throw InputError({{study.file.string(), 0, 0,
                       std::to_string(static_cast<long long>(std::min(all, 1e18))) +
                           " cases; at most " + std::to_string(kMostCases) + " in a study"}});
}

bool excluded(const Study& study, const Settings& settings) {
  const auto has = [&](const auto& named) {
    const auto setting = settings.find(named.first);
    return setting != settings.end() && std::ranges::count(named.second, setting->second) > 0;
  };
  return std::ranges::any_of(
      study.exclusions, [&](const Exclusion& one) { return std::ranges::all_of(one.when, has); });
}

/// The solvers to run on a scene: settings that a search chose for it, or all of the study.
const std::vector<std::string>& solvers_on(const Study& study, const std::string& scene) {
  if (study.searched.empty()) return study.solvers;
  const auto chosen = study.chosen.find(scene);
  if (chosen == study.chosen.end())
    throw InputError(
        {{study.searched.string(), 0, 0,
          "no settings for scene '" + scene + "': `taut advise --study " + study.name +
              (study.preset.empty() ? "" : " --preset " + study.preset) + "` searches them"}});
  return chosen->second;
}

CaseSpec spec_of(const Study& study, const std::string& scene, const std::string& solver,
                 const Settings& of_scene, const Settings& of_solver) {
  const StudyScene own = parse_study_scene(scene);
  CaseSpec spec{own.name, study.settings, solver};
  spec.settings.insert(spec.settings.end(), own.settings.begin(), own.settings.end());
  for (const StudyAxis& axis : study.axes)
    if (of_scene.contains(axis.name)) spec.settings.emplace_back(axis.name, of_scene.at(axis.name));
  for (const auto& [name, value] : of_solver)
    spec.solver = with(spec.solver, StudyAxis{name, {}}.parameter() + "=" + value);
  return spec;
}

}  // namespace

void each_case(const Study& study, const std::function<void(Case&&)>& visit) {
  require_few(study);
  CaseMaker maker;
  std::set<std::string> keys, said;
  std::vector<Diagnostic> wrong;
  const auto add = [&](const std::string& scene, const CaseSpec& spec) {
    try {
      admit_solver(spec.solver);  // an axis may name a file
      Case one = maker.make(spec);
      if (keys.insert(one.key).second) visit(std::move(one));
    } catch (const InputError& error) {
      for (const Diagnostic& of_scene : error.diagnostics())
        if (const Diagnostic d = placed(study, scene, of_scene); said.insert(d.text()).second)
          wrong.push_back(d);
    }
  };
  for (const std::string& scene : study.scenes)
    combinations(scene_axes(study), [&](const Settings& of_scene) {
      for (const std::string& solver : solvers_on(study, scene))
        combinations(solver_axes(study, solver), [&](const Settings& of_solver) {
          Settings all = of_scene;
          all.insert(of_solver.begin(), of_solver.end());
          all["scene"] = scene;
          all["solver"] = solver_name(solver);
          if (!excluded(study, all)) add(scene, spec_of(study, scene, solver, of_scene, of_solver));
        });
    });
  if (!wrong.empty()) throw InputError(wrong);
}

Study at_time_steps(Study study, const std::vector<std::string>& steps) {
  if (steps.empty()) return study;
  study.settings = without(std::move(study.settings), "time.dt");
  std::erase_if(study.axes, [](const StudyAxis& axis) { return axis.name == "time.dt"; });
  StudyAxis axis{.name = "time.dt", .values = {}};
  for (const std::string& step : steps) axis.values.push_back('"' + step + '"');
  study.axes.insert(study.axes.begin(), std::move(axis));
  study.name += " dt=" + join(steps, ",");
  return study;
}

Study of_build(Study study, const std::string& build) {
  if (build.empty()) return study;
  for (std::string& solver : study.solvers) {
    admit_solver(solver);
    const SolverChoice choice = parse_solver(solver);
    if (choice.params.has("build") && choice.params.value("build").empty())
      solver = with(solver, "build=" + build);
  }
  return study;
}

std::vector<Case> cases_of(const Study& study) {
  std::vector<Case> cases;
  each_case(study, [&](Case&& one) { cases.push_back(std::move(one)); });
  return cases;
}

}  // namespace taut
