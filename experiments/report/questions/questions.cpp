#include "experiments/report/questions/questions.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/questions/costs.hpp"
#include "experiments/report/questions/rows.hpp"
#include "experiments/timing/judge.hpp"

namespace taut::report {

namespace {

constexpr const char* kSweepsDiffer = "sweeps differ; each cell names its own";
/// Depths below a micrometre are rounding.
constexpr double kNoDepth = 1e-6;

bool is_depth(Role role) { return role == Role::vertex_depth || role == Role::face_depth; }

/// How the last row combines the scenes.
enum class Over { mean, largest, sum };
Over over_of(Role role) {
  return is_depth(role) ? Over::largest : role == Role::passages ? Over::sum : Over::mean;
}

class Questions {
 public:
  Questions(const ReportInput& input, const ComparedSolvers& compared, CaseList& list)
      : input_(input), compared_(compared), list_(list) {
    for (const ComparedSolver& solver : compared.all)
      solvers_.emplace_back(solver.name, solver.label);
    if (!input.bench) return;
    for (const SceneBench& scene : input.bench->scenes)
      for (const std::string& solver : solvers_of(scene))
        if (std::ranges::find(solvers_, solver, &Column::name) == solvers_.end())
          solvers_.emplace_back(solver, solver_title(solver));
  }

  Answer answer() {
    add_costs(answer_, input_, solvers_, list_);
    const auto values = [&](bool of_sweeps) {
      for (const ValueSpec* value : values_with_role())
        if ((value->role == Role::error) == of_sweeps) add_value(*value);
    };
    values(false);
    add_largest_steps(answer_, compared_, solvers_, list_);
    values(true);
    add_failures(answer_, compared_, solvers_, list_);
    answer_.subject = caption();
    return std::move(answer_);
  }

 private:
  /// The caption of all tables, in one line.
  std::string caption() const {
    std::set<double> steps;
    for (const QuotedScene& quoted : compared_.scenes)
      if (quoted.task.dt > 0) steps.insert(quoted.task.dt);
    const std::string work = compared_.common_work();
    return (input_.differences ? "B alone, " + input_.differences->b + ". " : std::string()) +
           (input_.bench ? "CPU times are per simulated second; only what rests on them is marked, "
                           "the cheapest or the most accurate at one cost. "
                         : "Nothing was timed, so no solver is marked as best. ") +
           (work.empty() ? capitalised(kSweepsDiffer) : "All else is at " + work) +
           (steps.empty() ? "" : "; time step " + range_text(steps, quantity("dt"))) +
           ". Means are geometric where all values are positive; those of stretch leave out cloth "
           "that is more than " +
           shown(kShare, kErrorLevels[0], 1) +
           " of its motion away from where it should be, where that is known.";
  }

  /// Adds a table of a value of the cases with the same substeps and sweeps, scene by scene. These
  /// cases differ in cost, so no cell is marked as best. An error that falls with sweeps has no
  /// value for solvers without sweeps.
  void add_value(const ValueSpec& spec) {
    const std::string metric(spec.name), work = compared_.common_work();
    const Quantity& q = list_.use(metric);
    const bool of_sweeps = spec.role == Role::error;
    const char* at = !of_sweeps ? "" : work.empty() ? " at unequal sweeps" : " at equal sweeps";
    Table table{metric, capitalised(q.title) + at, columns_of(solvers_, q.unit)};
    std::set<double> steps;
    for (const QuotedScene& quoted : compared_.scenes) {
      std::vector<Cell> row{Cell(quoted.title).of_scene(quoted.task.scene)};
      for (std::size_t i = 0; i < solvers_.size(); ++i)
        row.push_back(of_sweeps && solves_all_at_once(solvers_[i].name)
                          ? Cell::lacking(Cell::State::none, "does not sweep")
                          : value_cell(i < quoted.cases.size() ? quoted.cases[i] : nullptr, metric,
                                       of_sweeps));
      if (std::ranges::all_of(row, [](const Cell& c) { return std::isnan(c.number()); })) continue;
      steps.insert(quoted.task.dt);
      table.rows.push_back(std::move(row));
    }
    if (table.rows.empty()) return;
    const Over over = over_of(spec.role);
    const double floor = is_depth(spec.role) ? kNoDepth : spec.negligible;
    table.rows.push_back(sum_up(table, over, over == Over::mean ? floor : 0));
    table.caption = std::string(to_string(q.window)) + (q.window == Window::none ? "" : "; ") +
                    (work.empty() ? std::string(kSweepsDiffer) : work) + "; time step " +
                    range_text(steps, quantity("dt")) +
                    (of_sweeps ? "; sweeps cost unequally, and solvers that solve all links at "
                                 "once have none"
                               : "") +
                    (over == Over::mean && floor > 0
                         ? "; less than " + q.text(floor, 1) + " counts as " + q.text(floor, 1)
                         : "") +
                    (is_depth(spec.role) ? contact_text() : "");
    answer_.add(std::move(table));
  }

  /// When depths are measured, and which solvers correct only a part of them.
  std::string contact_text() const {
    std::string text =
        "; measured at the end of a step: solvers that project contact last end on the surface, "
        "those that solve it with the links where their iterations end";
    for (std::size_t i = 0; i < compared_.all.size(); ++i) {
      const std::string share = parameter_of(compared_.all[i].name, ParamSpec::Role::contact_share);
      std::set<std::string> values;
      for (const QuotedScene& quoted : compared_.scenes)
        if (const Record* r = quoted.cases[i]; r && r->params.contains(share))
          values.insert(r->params.at(share));
      if (!values.empty())
        text += "; " + solver_title(compared_.all[i].name) + " corrects a share of a depth, its " +
                share + ": " + join(values, " and ");
    }
    return text;
  }

  /// The cell of a value. For an error of strain, its note says if the cloth is not where it should
  /// be.
  Cell value_cell(const Record* r, const std::string& metric, bool of_strain) {
    const double value = r && completed(r->status) ? value_of(*r, metric) : std::nan("");
    Cell cell = std::isfinite(value) ? Cell(value) : why_none(r);
    if (!r) return cell;
    cell.key = list_.key(*r);
    if (of_strain && std::isfinite(value)) cell.note = astray(*r);
    if (!cell.note.empty()) cell.state = Cell::State::astray;
    if (compared_.common_work().empty()) {
      const Label work{{label_part(work_of(*r))}};
      cell.note += (cell.note.empty() ? "" : "; ") + work.text();
      cell.terms = work.terms();
    }
    return cell;
  }

  /// The last row. `floor` applies to means: smaller values count as `floor`, and scenes in which
  /// all values are smaller are left out.
  static std::vector<Cell> sum_up(const Table& table, Over over, double floor) {
    const Common common = common_of(table, floor);
    const auto value = [&](std::size_t r, std::size_t c) {
      const double own = table.rows[r][c].number();
      return floor > 0 ? std::max(own, floor) : own;
    };
    bool positive = true;  // otherwise there is no geometric mean
    for (const std::size_t r : common.rows)
      for (const std::size_t c : common.columns) positive = positive && value(r, c) > 0;
    const char* what = over == Over::largest ? "largest of"
                       : over == Over::sum   ? "sum of"
                                             : "mean of";
    return last_row(table, common, what, [&](std::size_t c) {
      double sum = 0;
      std::size_t largest = common.rows.front();
      for (const std::size_t r : common.rows) {
        sum += over == Over::mean && positive ? std::log(value(r, c)) : value(r, c);
        if (value(r, c) > value(largest, c)) largest = r;
      }
      const auto n = static_cast<double>(common.rows.size());
      if (over == Over::largest) return table.rows[largest][c];
      return Cell(over == Over::sum ? sum : positive ? std::exp(sum / n) : sum / n);
    });
  }

  const ReportInput& input_;
  const ComparedSolvers& compared_;
  CaseList& list_;
  std::vector<Column> solvers_;
  Answer answer_{"report", ""};
};

}  // namespace

Answer answer_of(const ReportInput& input, const ComparedSolvers& compared, CaseList& list) {
  return Questions(input, compared, list).answer();
}

}  // namespace taut::report
