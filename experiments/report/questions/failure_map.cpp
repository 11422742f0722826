#include "experiments/report/questions/failure_map.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/task.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/input.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/timing/judge.hpp"

namespace taut::report {

namespace {

/// kOff: distance from the converged motion above which a motion is not right. kStrained: distance
/// of the RMS strain from the reference's.
constexpr double kOff = 0.1, kStrained = 0.005, kGained = 0.02, kFrozen = 0.5;

using Stiffness = std::map<std::string, double>;

Stiffness stiffness_of(const Record& r) { return links_stiffness(r.spec.settings); }

/// How the case's settings write its stiffness: "structural = 1e3".
std::string stiffness_text(const Record& r) {
  std::string text = find_setting(r.spec.settings, kLinksStiffness)->value();
  std::erase_if(text, [](char c) { return c == '{' || c == '}'; });
  const auto first = text.find_first_not_of(' ');
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

/// What the cases of a column have in common.
struct ColumnKey {
  Task task;  ///< without stiffness
  Stiffness stiffness;
  bool operator==(const ColumnKey&) const = default;
};
ColumnKey column_key(const Record& r) {
  Task task = task_of(r);
  task.settings = without(std::move(task.settings), kLinksStiffness);
  return {std::move(task), stiffness_of(r)};
}

/// What the cases of a row have in common.
struct RowKey {
  std::string solver;
  std::map<std::string, std::string> params;
  bool operator==(const RowKey&) const = default;
};

/// The cases of the map, each in a place of its own.
class Grid {
 public:
  explicit Grid(const Records& cases) {
    for (const Record* r : cases) add(*r);
  }

  struct Row {
    RowKey key;
    std::vector<const Record*> cases;  ///< by column; may be shorter, and null where none was run
  };
  const std::vector<Row>& rows() const { return rows_; }
  std::size_t columns() const { return columns_.size(); }

  /// "swing, structural = 1e3", with whatever else distinguishes the columns of a scene.
  std::string heading(std::size_t column) const {
    std::set<Task> tasks;
    for (const Column& one : columns_) tasks.insert(one.key.task);
    const Task& task = columns_[column].key.task;
    const bool many_steps = std::ranges::any_of(
        tasks, [&](const Task& one) { return one.scene == task.scene && one.dt != task.dt; });
    return title_among(task, tasks) + (many_steps ? ", dt = " + shortest(task.dt) + " s" : "") +
           ", " + stiffness_text(*columns_[column].first);
  }

 private:
  struct Column {
    ColumnKey key;
    const Record* first;
  };

  std::size_t column_of(const Record& r) {
    const ColumnKey key = column_key(r);
    const auto at = std::ranges::find(columns_, key, &Column::key);
    if (at != columns_.end()) return static_cast<std::size_t>(at - columns_.begin());
    columns_.push_back({key, &r});
    return columns_.size() - 1;
  }
  /// Puts a case into the first row of its solver that has room for it. Another result of the same
  /// solver and task, such as another version's of an external program, opens one more row.
  void add(const Record& r) {
    const std::size_t column = column_of(r);
    const RowKey key{r.solver, r.params};
    for (Row& row : rows_) {
      if (row.key != key) continue;
      row.cases.resize(std::max(row.cases.size(), column + 1));
      if (!row.cases[column]) row.cases[column] = &r;
      if (row.cases[column]->key == r.key) return;
    }
    rows_.push_back({key, std::vector<const Record*>(column + 1)});
    rows_.back().cases[column] = &r;
  }

  std::vector<Column> columns_;
  std::vector<Row> rows_;
};

const char* verdict(const Record& r) {
  const auto value = [&](std::string_view name) { return r.value(std::string(name)); };
  if (strain_error(r) > kStrained) return "strains";
  if (judged_by(r) == JudgedBy::nothing) return "not judged";
  if (value("motion.share") < kFrozen) return "freezes";
  if (value(kMotionError) > kOff) return "is elsewhere";
  if (value("energy.peak") > kGained) return "gains energy";
  return "right";
}

/// Note of a case: "1.2 % from its motion, strain 0.086 %, energy -0.012, 20 ms a simulated
/// second".
std::string numbers(const Record& r) {
  std::vector<std::string> all;
  const auto add = [&](std::string_view name, const std::string& before, const std::string& after) {
    const double value = r.value(std::string(name));
    if (std::isfinite(value)) all.push_back(before + quantity(name).text(value) + after);
  };
  add(kMotionError, "", " from its motion");
  add("stretch.rms", "strain ", "");
  add("energy.peak", "energy ", " m g L");
  add(kCpuPerSecond, "", " a simulated second");
  return join(all, ", ");
}

Cell cell_of(const Record& r, CaseList* list) {
  const bool refused = r.status.kind == Status::Kind::unsupported;
  Cell cell = completed(r.status)
                  ? Cell(verdict(r)).with(numbers(r))
                  : Cell::lacking(refused ? Cell::State::refused : Cell::State::none,
                                  refused ? "cannot: " + r.status.reason.text()
                                          : std::string(to_string(r.status.kind)));
  if (list) cell.key = list->key(r);
  return cell;
}

}  // namespace

Table failure_map(const Records& records, const std::vector<Record>& timed, CaseList* list) {
  Table table{
      kFailureMap,
      "Who is right on soft, stiff, taut and slack cloth: who freezes, who strains",
      {Column("solver")},
      {},
      "strains: RMS stretch more than " + shown(kShare, kStrained, 1) +
          " from the reference\u2019s; freezes: makes less than " + shown(kShare, kFrozen, 2) +
          " of the reference\u2019s motion; is elsewhere: more than " + shown(kShare, kOff, 2) +
          " of the motion away from it; gains energy: above " + shown(kShare, kGained, 1) +
          " of m g L more than at the start; else right. A cell has the first of these that "
          "holds. Not judged: no reference in motion is known for this stiffness."};
  Records here;
  for (const Record* r : records) {
    if (stiffness_of(*r).empty()) continue;
    const auto with_cost = std::ranges::find(timed, r->key, &Record::key);
    here.push_back(with_cost == timed.end() ? r : &*with_cost);
  }
  if (distinct(here, [](const Record* r) { return stiffness_of(*r); }).size() < 2) return table;
  const Grid grid(here);
  for (std::size_t i = 0; i < grid.columns(); ++i) {
    const std::string heading = grid.heading(i);
    table.columns.emplace_back(heading, heading);
  }
  for (const Grid::Row& row : grid.rows()) {
    const Record& any = **std::ranges::find_if(row.cases, std::identity());
    std::vector<Cell>& cells = table.rows.emplace_back(grid.columns() + 1);
    cells[0] = titled(any.solver, brief_settings(any));
    for (std::size_t i = 0; i < row.cases.size(); ++i)
      if (row.cases[i]) cells[i + 1] = cell_of(*row.cases[i], list);
  }
  return table;
}

}  // namespace taut::report
