// The question of failures: how the cases ended that all solvers of a scene ran.
#include <algorithm>
#include <map>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/report/questions/questions.hpp"
#include "experiments/report/questions/rows.hpp"

namespace taut::report {

namespace {

/// How the cases of a solver ended, and the key of one that failed.
struct Count {
  int cases = 0, failed = 0;
  std::map<std::string, int> kinds = {};
  std::string key = {};

  void add(const Record& r) {
    ++cases;
    if (completed(r.status)) return;
    const bool fails = taut::failed(r.status);
    failed += fails;
    ++kinds[fails ? std::string(to_string(r.status.kind)) : "unsupported"];
    if (fails && key.empty()) key = r.key;
  }
  void add(const Count& other) {
    cases += other.cases;
    failed += other.failed;
    for (const auto& [kind, n] : other.kinds) kinds[kind] += n;
    if (key.empty()) key = other.key;
  }
};

/// The cases of one solver on a scene.
using Ran = std::map<std::pair<Task, Work>, const Record*>;

/// Counts for each solver only those cases that were run by every solver with any case on the
/// scene.
std::vector<Count> shared_counts(const std::vector<Ran>& solvers) {
  std::vector<Count> counts(solvers.size());
  for (std::size_t i = 0; i < solvers.size(); ++i)
    for (const auto& [ran, record] : solvers[i])
      if (std::ranges::all_of(solvers, [&, &ran = ran](const Ran& other) {
            return other.empty() || other.contains(ran);
          }))
        counts[i].add(*record);
  return counts;
}

std::vector<Cell> row_of(Cell head, const std::vector<Count>& counts, CaseList& list) {
  std::vector<Cell> row{std::move(head)};
  for (const Count& count : counts) {
    const std::string kinds = join(count.kinds, ", ", [](const auto& kind) {
      return std::to_string(kind.second) + " " + kind.first;
    });
    row.push_back(count.cases == 0 ? why_none(nullptr)
                                   : Cell(count.failed)
                                         .with("of " + std::to_string(count.cases) +
                                               (kinds.empty() ? "" : ": " + kinds)));
    if (!count.key.empty()) row.back().key = list.key(count.key);
  }
  mark_least(row, 0);
  return row;
}

/// "; of all 240 cases of this page, 3 failed"
std::string on_whole_page(const CaseList& list) {
  const auto failures =
      std::ranges::count_if(list.cases(), [](const Record* r) { return failed(r->status); });
  return "; of all " + std::to_string(list.cases().size()) + " cases of this page, " +
         std::to_string(failures) + " failed";
}

}  // namespace

void add_failures(Answer& answer, const ComparedSolvers& compared,
                  const std::vector<Column>& solvers, CaseList& list) {
  // The number of failures among cases that are not shared depends on which cases each solver ran.
  Table table{"failures",
              "Cases that failed",
              columns_of(solvers, kErrorCount),
              {},
              "of those that all solvers of the scene ran: same settings of the scene, substeps × "
              "sweeps and time step"};
  std::vector<std::string> order;
  std::map<std::string, std::vector<Ran>> scenes;
  for (std::size_t i = 0; i < compared.all.size(); ++i)
    for (const Record* r : compared.all[i].cases) {
      const auto [scene, fresh] = scenes.try_emplace(r->scene, solvers.size());
      if (fresh) order.push_back(r->scene);
      scene->second[i].try_emplace({task_of(*r), work_of(*r)}, r);
    }
  std::vector<Count> sum(solvers.size());
  int summed = 0;
  for (const std::string& scene : order) {
    const std::vector<Count> counts = shared_counts(scenes.at(scene));
    if (std::ranges::all_of(counts, [](const Count& one) { return one.cases == 0; })) continue;
    table.rows.push_back(row_of(Cell(scene).of_scene(scene), counts, list));
    if (std::ranges::any_of(counts, [](const Count& one) { return one.cases == 0; })) {
      table.rows.back()[0].note = "not in the sum: not all ran it";
      continue;
    }
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i].add(counts[i]);
    ++summed;
  }
  if (table.rows.empty()) return;
  table.rows.push_back(
      row_of("sum of " + std::to_string(summed) + (summed == 1 ? " scene" : " scenes"), sum, list));
  table.caption += on_whole_page(list);
  answer.add(std::move(table));
}

}  // namespace taut::report
