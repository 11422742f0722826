// The question of the largest stable time step: the same setting of a solver at several time steps.
#include <map>
#include <set>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/report/questions/questions.hpp"
#include "experiments/report/questions/rows.hpp"

namespace taut::report {

namespace {

/// Fewest time steps on a scene that make a largest one meaningful, and the least ratio between the
/// largest and the smallest of them.
constexpr std::size_t kLeastSteps = 3;
constexpr double kLeastRange = 4;

/// The works and time steps that a solver tried on a scene, with the same settings.
using Tried = std::map<std::pair<Work, double>, const Record*>;

std::set<double> steps_of(const Tried& tried) {
  std::set<double> steps;
  for (const auto& [at, record] : tried) steps.insert(at.second);
  return steps;
}

/// The works and time steps that all of these solvers tried.
Tried shared_by(const std::vector<const Tried*>& solvers) {
  Tried shared = *solvers.front();
  std::erase_if(shared, [&](const auto& one) {
    return std::ranges::any_of(solvers,
                               [&](const Tried* own) { return !own->contains(one.first); });
  });
  return shared;
}

/// Text of the works: "1, 4 and 16 sweeps", with the substeps if they are not all 1.
std::string works_text(const Tried& tried) {
  std::set<Work> works;
  bool one = true;
  for (const auto& [at, record] : tried) {
    works.insert(at.first);
    one = one && at.first.substeps <= 1;
  }
  std::vector<std::string> names;
  for (const Work& work : works) names.push_back(one ? std::to_string(work.sweeps) : work.text());
  if (!one) return joined(names) + " substeps × sweeps";
  return joined(names) + (names == std::vector<std::string>{"1"} ? " sweep" : " sweeps");
}

/// Largest step for which, and for all smaller ones, every case completed.
Cell largest_stable(const Tried& own, const Tried& shared, const std::set<double>& steps,
                    CaseList& list) {
  Cell cell = Cell::lacking(Cell::State::none, "below " + quantity("dt").text(*steps.begin(), 3));
  for (const double dt : steps) {
    const Record* last = nullptr;
    for (const auto& [at, any] : shared) {
      if (at.second != dt) continue;
      last = own.at(at);
      if (completed(last->status)) continue;
      if (cell.key.empty()) cell.key = list.key(*last);
      return cell.with("then " + why_none(last).text());
    }
    cell = Cell(dt);
    cell.key = list.key(*last);
  }
  return cell.with("the largest tried");
}

/// Row of a task; `tried` is indexed by solver. Nothing if the solvers have too few steps in
/// common.
std::optional<std::vector<Cell>> row_of(const Task& task, const std::vector<Tried>& tried,
                                        std::size_t columns, const ComparedSolvers& compared,
                                        CaseList& list) {
  std::vector<const Tried*> enough;
  for (const Tried& own : tried)
    if (steps_of(own).size() >= kLeastSteps) enough.push_back(&own);
  if (enough.empty()) return {};
  const Tried shared = shared_by(enough);
  const std::set<double> steps = steps_of(shared);
  if (steps.size() < kLeastSteps || *steps.rbegin() < kLeastRange * *steps.begin()) return {};
  std::vector<Cell> row{
      Cell(compared.title(task)).with("at " + works_text(shared)).of_scene(task.scene)};
  for (std::size_t i = 0; i < columns; ++i) {
    const bool ran = i < tried.size() && std::ranges::find(enough, &tried[i]) != enough.end();
    row.push_back(ran ? largest_stable(tried[i], shared, steps, list) : why_none(nullptr));
  }
  return row;
}

}  // namespace

void add_largest_steps(Answer& answer, const ComparedSolvers& compared,
                       const std::vector<Column>& solvers, CaseList& list) {
  Table table{kLargestStep,
              "Largest stable time step",
              columns_of(solvers, quantity("dt").unit, 3),
              {},
              "up to it every case completed, at the least work of a row, too: the worst of the "
              "substeps × sweeps that all of its solvers tried"};
  std::map<Task, std::vector<Tried>> scenes;
  for (std::size_t i = 0; i < compared.all.size(); ++i)
    for (const Record* r : compared.all[i].cases) {
      if (work_of(*r).sweeps <= 0) continue;
      Task task = task_of(*r);
      task.dt = 0;  // all its time steps share a row
      auto& tried = scenes[std::move(task)];
      tried.resize(compared.all.size());
      tried[i].try_emplace({work_of(*r), r->dt}, r);
    }
  for (const auto& [task, tried] : scenes)
    if (auto row = row_of(task, tried, solvers.size(), compared, list))
      table.rows.push_back(std::move(*row));
  if (table.rows.empty()) return;
  const Common common = common_of(table, 0);
  table.rows.push_back(last_row(table, common, "mean of", [&](std::size_t column) {
    std::vector<Interval> steps;
    for (const std::size_t r : common.rows) {
      const double dt = table.rows[r][column].number();
      steps.push_back({dt, dt, dt});
    }
    return Cell(geometric_mean(steps).mid);
  }));
  list.use("dt");
  answer.add(std::move(table));
}

}  // namespace taut::report
