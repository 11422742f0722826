#include "experiments/report/questions/compared_solvers.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "experiments/case/record_io.hpp"
#include "experiments/system/distinct.hpp"

namespace taut::report {

namespace {

ComparedSolver choose(const std::string& solver, const std::vector<const Record*>& cases) {
  std::vector<std::vector<const Record*>> groups;
  std::map<std::map<std::string, std::string>, std::size_t> index;
  // Number of groups with that setting.
  std::map<std::pair<std::string, std::string>, std::size_t> having;
  for (const Record* r : cases) {
    const auto choice = other_settings(*r);
    const auto [at, fresh] = index.try_emplace(choice, groups.size());
    if (fresh) groups.emplace_back();
    if (fresh)
      for (const auto& setting : choice) ++having[setting];
    groups[at->second].push_back(r);
  }
  const auto most = std::ranges::max_element(groups, {}, [](const auto& g) { return g.size(); });
  ComparedSolver chosen{solver, solver_title(solver), *most};
  for (const auto& setting : other_settings(*most->front()))
    if (having.at(setting) < groups.size())
      chosen.label += " " + named_setting(setting.first, setting.second);
  return chosen;
}

/// Distance, in logarithms, from kQuotedWork.
double distance(const Work& work) {
  const auto apart = [](int a, int b) {
    return std::abs(std::log(std::max(1, a) / static_cast<double>(b)));
  };
  return apart(work.sweeps, kQuotedWork.sweeps) + apart(work.substeps, kQuotedWork.substeps);
}

/// The work that a solver ran most often among those that `admits` accepts; in a tie the one
/// nearest to kQuotedWork.
template <class Admits>
Work commonest_work(const ComparedSolver& solver, Admits admits) {
  std::map<Work, int> counts;
  for (const Record* r : solver.cases)
    if (const Work work = work_of(*r); admits(work)) ++counts[work];
  const auto best = std::ranges::max_element(counts, {}, [](const auto& entry) {
    return std::pair(entry.second, -distance(entry.first));
  });
  return best == counts.end() ? Work{} : best->first;
}

/// Chooses the work at which each compared solver is quoted: of the works that all solvers with
/// sweeps ran, the one nearest to kQuotedWork. If no work is common, each solver has its own, with
/// the same number of sweeps if possible.
void choose_work(std::vector<ComparedSolver>& compared) {
  std::map<Work, int> counts;
  std::map<int, int> sweep_counts;
  int having = 0;
  for (const ComparedSolver& solver : compared) {
    std::set<Work> works;
    std::set<int> sweeps;
    for (const Record* r : solver.cases)
      if (const Work work = work_of(*r); work.sweeps > 0) {
        works.insert(work);
        sweeps.insert(work.sweeps);
      }
    having += !works.empty();
    for (const Work& work : works) ++counts[work];
    for (const int n : sweeps) ++sweep_counts[n];
  }
  std::erase_if(counts, [&](const auto& entry) { return entry.second < having; });
  std::erase_if(sweep_counts, [&](const auto& entry) { return entry.second < having; });
  const auto nearest =
      std::ranges::min_element(counts, {}, [](const auto& entry) { return distance(entry.first); });
  const auto same_sweeps = std::ranges::min_element(sweep_counts, {}, [](const auto& entry) {
    return distance({kQuotedWork.substeps, entry.first});
  });
  for (ComparedSolver& solver : compared)
    solver.work = commonest_work(solver, [&](const Work& work) {
      if (work.sweeps <= 0) return true;
      if (!counts.empty()) return work == nearest->first;
      return sweep_counts.empty() || work.sweeps == same_sweeps->first;
    });
}

/// The task that most solvers ran at their work; in a tie the one with the time step nearest to
/// kQuotedStep.
QuotedScene quote(const std::string& scene, const std::vector<ComparedSolver>& compared) {
  std::vector<QuotedScene> asked;
  for (std::size_t i = 0; i < compared.size(); ++i)
    for (const Record* r : compared[i].cases) {
      if (r->scene != scene || work_of(*r) != compared[i].work) continue;
      const Task task = task_of(*r);
      auto at = std::ranges::find(asked, task, &QuotedScene::task);
      if (at == asked.end())
        at = asked.insert(at, {task, scene, std::vector<const Record*>(compared.size())});
      if (!at->cases[i]) at->cases[i] = r;
    }
  const auto rank = [](const QuotedScene& q) {
    return std::pair(std::ranges::count(q.cases, nullptr),
                     std::abs(std::log(q.task.dt / kQuotedStep)));
  };
  const auto best = std::ranges::min_element(asked, {}, rank);
  if (best == asked.end())
    return {{scene, {}, 0}, scene, std::vector<const Record*>(compared.size())};
  return *best;
}

}  // namespace

const QuotedScene* ComparedSolvers::quoted(const std::string& scene) const {
  const auto at =
      std::ranges::find_if(scenes, [&](const QuotedScene& q) { return q.task.scene == scene; });
  return at == scenes.end() ? nullptr : &*at;
}

std::string ComparedSolvers::common_work() const {
  std::set<Work> works;
  for (const ComparedSolver& solver : all) works.insert(solver.work);
  if (works.size() != 1) return "";
  const Work& work = *works.begin();
  return work.text() + (work.sweeps > 0 && work.substeps > 0 ? " (substeps × sweeps)" : "");
}

namespace {

Task untimed(Task task) {
  std::erase_if(task.settings, [](const SceneSetting& one) { return one.is_of_time(); });
  task.dt = 0;
  return task;
}

}  // namespace

std::string ComparedSolvers::title(Task task) const {
  return title_among(untimed(std::move(task)), asked);
}

ComparedSolvers compared_solvers_of(const ReportInput& input) {
  ComparedSolvers compared;
  std::vector<std::string> solvers, scenes;
  std::set<std::string_view> keys;
  std::map<std::string, std::vector<const Record*>> by_solver;
  for (const StudyResult& study : input.studies)
    for (const Record& r : study.records) {
      if (!keys.insert(r.key.empty() ? r.id : r.key).second) continue;
      push_unique(solvers, r.solver);
      push_unique(scenes, r.scene);
      compared.asked.insert(untimed(task_of(r)));
      by_solver[r.solver].push_back(&r);
    }
  for (const std::string& solver : solvers)
    compared.all.push_back(choose(solver, by_solver[solver]));
  choose_work(compared.all);
  for (const std::string& scene : scenes) {
    QuotedScene& quoted = compared.scenes.emplace_back(quote(scene, compared.all));
    quoted.title = compared.title(quoted.task);
  }
  return compared;
}

}  // namespace taut::report
