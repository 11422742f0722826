#include "experiments/report/answer/answer.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/timing/hardly_moves.hpp"

namespace taut::report {

Interval geometric_mean(const std::vector<Interval>& ratios) {
  double mid = 0, below = 0, above = 0;
  for (const Interval& r : ratios) {
    mid += std::log(r.mid);
    below += std::pow(std::log(r.mid / r.low), 2);
    above += std::pow(std::log(r.high / r.mid), 2);
  }
  const auto n = static_cast<double>(ratios.size());
  return {std::exp((mid - std::sqrt(below)) / n), std::exp(mid / n),
          std::exp((mid + std::sqrt(above)) / n)};
}

std::vector<Column> columns_of(const std::vector<Column>& solvers, const Unit& unit, int digits) {
  std::vector<Column> columns{Column("scene")};
  for (const Column& solver : solvers)
    columns.emplace_back(solver.name, solver.heading, unit, digits);
  return columns;
}

std::string Arithmetic::brief() const {
  return lanes == 0 ? precision : precision + " × " + std::to_string(lanes);
}

std::string Arithmetic::text() const {
  if (instructions.empty()) return precision;
  return lanes == 0 ? precision + ", " + instructions : brief() + " (" + instructions + ")";
}

std::string Arithmetic::meaning() const {
  const std::string text = precision == "float" ? "single precision" : "double precision";
  return lanes == 0 ? text : text + ", " + std::to_string(lanes) + " numbers in one instruction";
}

Arithmetic arithmetic_of(const Record& r, const std::string& vectors) {
  const auto param = [&](const char* name) {
    const auto at = r.params.find(name);
    return at == r.params.end() ? std::string() : at->second;
  };
  Arithmetic all{.precision = param("precision")};
  if (all.precision.empty()) return {};  // its links have no kernels of vectors
  const bool automatic = param("simd") == "auto";
  all.instructions = automatic ? vectors : param("simd");
  if (all.instructions.empty()) {
    if (automatic) all.instructions = "vectors";
    return all;
  }
  for (const auto& [name, bytes] :
       {std::pair<const char*, int>{"sse2", 16}, {"avx2", 32}, {"avx512", 64}})
    if (all.instructions == name) all.lanes = bytes / (all.precision == "float" ? 4 : 8);
  return all;
}

std::string link_order(const Record& r) {
  const ResolvedSetting* order = find_setting(r.resolved_settings, kLinkOrder);
  return order ? order->compared() : "";
}

bool is_compared(const Cell& cell) {
  return !std::isnan(cell.number()) && cell.state == Cell::State::value;
}

void mark_least(std::vector<Cell>& row, double nothing) {
  Cell *least = nullptr, *second = nullptr;
  const auto value = [&](const Cell& cell) { return std::max(cell.number(), nothing); };
  for (Cell& cell : row) {
    if (!is_compared(cell)) continue;
    if (!least || value(cell) < value(*least))
      second = std::exchange(least, &cell);
    else if (!second || value(cell) < value(*second))
      second = &cell;
  }
  if (second) least->best = value(*second) > (1 + kTolerance) * value(*least);
}

Common common_of(const Table& table, double nothing) {
  Common common;
  for (std::size_t c = 1; c < table.columns.size(); ++c)
    if (std::ranges::any_of(table.rows, [&](const auto& row) { return is_compared(row[c]); }))
      common.columns.push_back(c);
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const auto& row = table.rows[r];
    if (std::ranges::all_of(common.columns, [&](std::size_t c) { return is_compared(row[c]); }) &&
        (nothing <= 0 || std::ranges::any_of(common.columns, [&](std::size_t c) {
           return row[c].number() >= nothing;
         })))
      common.rows.push_back(r);
  }
  return common;
}

Cell Common::label(const Table& table, const std::string& what) const {
  if (rows.size() == 1 && table.rows.size() == 1) return table.rows[0][0];
  std::string without;
  for (std::size_t r = 0; r < table.rows.size(); ++r)
    if (std::ranges::find(rows, r) == rows.end())
      without += (without.empty() ? "without " : ", ") + table.rows[r][0].text();
  return Cell(what + " " + std::to_string(rows.size()) + (rows.size() == 1 ? " scene" : " scenes"))
      .with(without);
}

Cell why_empty(const Table& table, std::size_t column) {
  std::set<std::string> words;
  std::set<Cell::State> states;
  for (const auto& row : table.rows) {
    const Cell& cell = row[column];
    states.insert(cell.state);
    words.insert(std::isnan(cell.number()) ? cell.text() : "hardly moves");
  }
  if (words.size() != 1) return Cell::lacking(Cell::State::none, "no value");
  return Cell::lacking(states.size() == 1 ? *states.begin() : Cell::State::none, *words.begin());
}

Cell no_common_scene() { return Cell::lacking(Cell::State::none, "no scene that all have"); }

namespace {

/// A micrometre: a depth below it is rounding.
constexpr double kNoDepth = 1e-6;

/// A map needs at least this many time steps, over at least this range, to have a largest one.
constexpr std::size_t kLeastSteps = 3;
constexpr double kLeastRange = 4;

bool is_failure(const Status& status) {
  return !completed(status) && status.kind != Status::Kind::unsupported;
}

/// What stands in a cell instead of a value.
Cell why_none(const Record* r) {
  if (!r) return Cell::lacking(Cell::State::not_run, "not run");
  if (completed(r->status)) return Cell::lacking(Cell::State::none, "no value");
  if (r->status.kind == Status::Kind::unsupported)
    return Cell::lacking(Cell::State::refused, "cannot: " + r->status.reason);
  return Cell::lacking(Cell::State::none, std::string(to_string(r->status.kind)));
}

bool is_depth(Role role) { return role == Role::vertex_depth || role == Role::face_depth; }

/// What the last row has of all scenes.
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
    add_steps();
    values(true);
    add_failures();
    answer_.subject = caption();
    return std::move(answer_);
  }

 private:
  /// What all of it rests on, one line.
  std::string caption() const {
    std::set<double> steps;
    for (const QuotedScene& quoted : compared_.scenes)
      if (quoted.question.dt > 0) steps.insert(quoted.question.dt);
    const std::string work = compared_.common_work();
    return (input_.differences ? "B alone, " + input_.differences->b + ". " : std::string()) +
           (input_.bench ? "CPU times are per simulated second; only what rests on them is marked, "
                           "the cheapest or the most accurate at one cost. "
                         : "Nothing was timed, so no solver is marked as best. ") +
           "All else: " + (work.empty() ? "sweeps differ, in each cell" : work) +
           (steps.empty() ? "" : ", time step " + range_text(steps, quantity("dt"))) +
           ". Means are geometric where all values are positive; no stretch of cloth that goes "
           "less than " +
           shown(kShare, kLeastMotion, 1) + " of the way, as far as that is judged, is in one.";
  }

  /// The cases at the same substeps and sweeps, scene by scene. They cost unequally, so nobody is
  /// best; an error that falls with sweeps is one of solvers that sweep.
  void add_value(const ValueSpec& spec) {
    const std::string metric(spec.name), work = compared_.common_work();
    const Quantity& q = list_.use(metric);
    const bool of_sweeps = spec.role == Role::error;
    const char* at = !of_sweeps ? "" : work.empty() ? " at unequal sweeps" : " at equal sweeps";
    Table table{metric, capitalised(q.title) + at, columns_of(solvers_, q.unit)};
    std::set<double> steps;
    for (const QuotedScene& quoted : compared_.scenes) {
      std::vector<Cell> row{Cell(quoted.title).of_scene(quoted.question.scene)};
      for (std::size_t i = 0; i < solvers_.size(); ++i)
        row.push_back(of_sweeps && solves_all_at_once(solvers_[i].name)
                          ? Cell::lacking(Cell::State::none, "does not sweep")
                          : value_cell(i < quoted.cases.size() ? quoted.cases[i] : nullptr, metric,
                                       of_sweeps));
      if (std::ranges::all_of(row, [](const Cell& c) { return std::isnan(c.number()); })) continue;
      steps.insert(quoted.question.dt);
      table.rows.push_back(std::move(row));
    }
    if (table.rows.empty()) return;
    const Over over = over_of(spec.role);
    const double nothing = is_depth(spec.role) ? kNoDepth : spec.negligible;
    table.rows.push_back(last_row(table, over, over == Over::mean ? nothing : 0));
    table.caption = std::string(to_string(q.window)) + (q.window == Window::none ? "" : "; ") +
                    (work.empty() ? "sweeps differ, in each cell" : work) + "; time step " +
                    range_text(steps, quantity("dt")) +
                    (of_sweeps ? "; sweeps cost unequally, and solvers that solve all links at "
                                 "once have none"
                               : "") +
                    (over == Over::mean && nothing > 0
                         ? "; less than " + q.text(nothing, 1) + " counts as " + q.text(nothing, 1)
                         : "") +
                    (is_depth(spec.role) ? contact_text() : "");
    answer_.add(std::move(table));
  }

  /// When depths are measured, and who leaves some of them by intent.
  std::string contact_text() const {
    std::string text =
        "; measured at the end of a step: solvers that project contact last end on the surface, "
        "those that solve it with the links where their iterations end";
    for (std::size_t i = 0; i < compared_.all.size(); ++i) {
      std::set<std::string> values;
      for (const QuotedScene& quoted : compared_.scenes)
        if (const Record* r = quoted.cases[i]; r && r->params.contains("hardness"))
          values.insert(r->params.at("hardness"));
      if (!values.empty())
        text += "; " + solver_title(compared_.all[i].name) +
                " corrects a share of a depth, its "
                "contact hardness: " +
                join(values, " and ");
    }
    return text;
  }

  /// Of an error of strain a note says whether the cloth moves at all.
  Cell value_cell(const Record* r, const std::string& metric, bool of_strain) {
    const double value = r && completed(r->status) ? value_of(*r, metric) : std::nan("");
    Cell cell = std::isfinite(value) ? Cell(value) : why_none(r);
    if (!r) return cell;
    cell.key = list_.key(*r);
    if (of_strain && std::isfinite(value)) cell.note = hardly_moves(*r);
    if (!cell.note.empty()) cell.state = Cell::State::hardly_moves;
    if (compared_.common_work().empty())
      cell.note += (cell.note.empty() ? "" : "; ") + work_of(*r).text();
    return cell;
  }

  /// `nothing` of a mean: what is less counts as that, and scenes where all are less do not count.
  std::vector<Cell> last_row(const Table& table, Over over, double nothing) const {
    const Common common = common_of(table, nothing);
    const auto value = [&](std::size_t r, std::size_t c) {
      const double own = table.rows[r][c].number();
      return nothing > 0 ? std::max(own, nothing) : own;
    };
    bool positive = true;  // only then is there a geometric mean
    for (const std::size_t r : common.rows)
      for (const std::size_t c : common.columns) positive = positive && value(r, c) > 0;
    std::vector<Cell> last{common.label(table, over == Over::largest ? "largest of"
                                               : over == Over::sum   ? "sum of"

                                                                   : "mean of")};
    for (std::size_t c = 1; c < table.columns.size(); ++c) {
      if (std::ranges::find(common.columns, c) == common.columns.end()) {
        last.push_back(why_empty(table, c));
        continue;
      }
      if (common.rows.empty()) {
        last.push_back(no_common_scene());
        continue;
      }
      double sum = 0;
      std::size_t largest = common.rows.front();
      for (const std::size_t r : common.rows) {
        sum += over == Over::mean && positive ? std::log(value(r, c)) : value(r, c);
        if (value(r, c) > value(largest, c)) largest = r;
      }
      const auto n = static_cast<double>(common.rows.size());
      if (over == Over::largest || common.rows.size() == 1) {
        last.push_back(table.rows[largest][c]);
        last.back().best = false;
      } else
        last.emplace_back(over == Over::sum ? sum : positive ? std::exp(sum / n) : sum / n);
    }
    return last;
  }

  /// Time steps and works that each solver tried on a scene with the same settings.
  using Tried = std::map<std::pair<Work, double>, const Record*>;

  void add_steps() {
    Table table{"largest_step",
                "Largest stable time step",
                columns_of(solvers_, quantity("dt").unit, 3),
                {},
                "up to it every case completed, at the least work of a row, too: the worst of the "
                "substeps × sweeps that all of its solvers tried"};
    std::map<std::pair<std::string, std::vector<std::string>>, std::vector<Tried>> scenes;
    for (std::size_t i = 0; i < compared_.all.size(); ++i)
      for (const Record* r : compared_.all[i].cases) {
        if (work_of(*r).sweeps <= 0) continue;
        auto& tried = scenes[{r->scene, question_of(*r).overrides}];
        tried.resize(compared_.all.size());
        tried[i].try_emplace({work_of(*r), r->dt}, r);
      }
    for (const auto& [scene, tried] : scenes) add_step_row(table, scene, tried);
    if (table.rows.empty()) return;
    const Common common = common_of(table, 0);
    std::vector<Cell> last{common.label(table, "mean of")};
    for (std::size_t c = 1; c < table.columns.size(); ++c) {
      std::vector<Interval> steps;
      for (const std::size_t r : common.rows) {
        const double dt = table.rows[r][c].number();
        steps.push_back({dt, dt, dt});
      }
      const bool has = std::ranges::find(common.columns, c) != common.columns.end();
      if (!has)
        last.push_back(why_empty(table, c));
      else if (steps.empty())
        last.push_back(no_common_scene());
      else
        last.emplace_back(geometric_mean(steps).mid);
      if (has && steps.size() == 1) last.back() = table.rows[common.rows[0]][c];
    }
    table.rows.push_back(std::move(last));
    list_.use("dt");
    answer_.add(std::move(table));
  }

  void add_step_row(Table& table, const std::pair<std::string, std::vector<std::string>>& scene,
                    const std::vector<Tried>& tried) {
    const auto steps_of = [](const Tried& own) {
      std::set<double> steps;
      for (const auto& [at, record] : own) steps.insert(at.second);
      return steps;
    };
    std::vector<const Tried*> here;
    for (const Tried& own : tried)
      if (steps_of(own).size() >= kLeastSteps) here.push_back(&own);
    if (here.empty()) return;
    Tried shared = *here.front();
    std::erase_if(shared, [&](const auto& one) {
      return std::ranges::any_of(here, [&](const Tried* own) { return !own->contains(one.first); });
    });
    const std::set<double> steps = steps_of(shared);
    if (steps.size() < kLeastSteps || *steps.rbegin() < kLeastRange * *steps.begin()) return;
    std::vector<Cell> row{Cell(compared_.title({scene.first, scene.second, 0}))
                              .with("at " + works_text(shared))
                              .of_scene(scene.first)};
    for (std::size_t i = 0; i < solvers_.size(); ++i) {
      const bool ran = i < tried.size() && std::ranges::find(here, &tried[i]) != here.end();
      row.push_back(ran ? largest_stable(tried[i], shared, steps) : why_none(nullptr));
    }
    table.rows.push_back(std::move(row));
  }

  /// "1, 4 and 16 sweeps", with their substeps where these are not 1.
  static std::string works_text(const Tried& tried) {
    std::set<Work> works;
    bool one = true;
    for (const auto& [at, record] : tried) {
      works.insert(at.first);
      one = one && at.first.substeps <= 1;
    }
    std::vector<std::string> names;
    for (const Work& work : works) names.push_back(one ? std::to_string(work.sweeps) : work.text());
    return joined(names) + (one ? names == std::vector<std::string>{"1"} ? " sweep" : " sweeps"
                                : " substeps × sweeps");
  }

  /// The largest step up to which (itself included) every case completed.
  Cell largest_stable(const Tried& own, const Tried& shared, const std::set<double>& steps) {
    Cell cell = Cell::lacking(Cell::State::none, "below " + quantity("dt").text(*steps.begin(), 3));
    for (const double dt : steps) {
      const Record* one = nullptr;
      for (const auto& [at, any] : shared) {
        if (at.second != dt) continue;
        one = own.at(at);
        if (completed(one->status)) continue;
        if (cell.key.empty()) cell.key = list_.key(*one);
        return cell.with("then " + why_none(one).text());
      }
      cell = Cell(dt);
      cell.key = list_.key(*one);
    }
    return cell.with("the largest tried");
  }

  /// How the cases of a solver ended, and one that failed.
  struct Count {
    int cases = 0, failed = 0;
    std::map<std::string, int> kinds = {};
    std::string key = {};

    void add(const Record& r) {
      ++cases;
      if (completed(r.status)) return;
      const bool fails = is_failure(r.status);
      failed += fails;
      ++kinds[fails ? std::string(to_string(r.status.kind)) : "unsupported"];
      if (fails && key.empty()) key = r.key;
    }
    void add(const Count& other) {
      cases += other.cases, failed += other.failed;
      for (const auto& [kind, n] : other.kinds) kinds[kind] += n;
      if (key.empty()) key = other.key;
    }
  };
  using Asked = std::map<std::pair<Question, Work>, const Record*>;

  /// Of the cases that all solvers of a scene ran; how many fail of what is not shared depends on
  /// what was asked of whom.
  void add_failures() {
    Table table{
        "failures",
        "Cases that failed",
        columns_of(solvers_, kErrorCount),
        {},
        "of those that all solvers of the scene ran: same settings of the scene, substeps × "
        "sweeps and time step"};
    std::vector<std::string> order;
    std::map<std::string, std::vector<Asked>> scenes;
    for (std::size_t i = 0; i < compared_.all.size(); ++i)
      for (const Record* r : compared_.all[i].cases) {
        const auto [scene, fresh] = scenes.try_emplace(r->scene, solvers_.size());
        if (fresh) order.push_back(r->scene);
        scene->second[i].try_emplace({question_of(*r), work_of(*r)}, r);
      }
    std::vector<Count> all(solvers_.size());
    int summed = 0;
    for (const std::string& scene : order) {
      const std::vector<Count> counts = shared_counts(scenes.at(scene));
      if (std::ranges::all_of(counts, [](const Count& one) { return one.cases == 0; })) continue;
      table.rows.push_back(failure_row(Cell(scene).of_scene(scene), counts));
      const bool whole = std::ranges::all_of(counts, [](const Count& c) { return c.cases > 0; });
      for (std::size_t i = 0; whole && i < all.size(); ++i) all[i].add(counts[i]);
      if (whole)
        ++summed;
      else
        table.rows.back()[0].note = "not in the sum: not all ran it";
    }
    if (table.rows.empty()) return;
    table.rows.push_back(failure_row(
        "sum of " + std::to_string(summed) + (summed == 1 ? " scene" : " scenes"), all));
    int cases = 0, failed = 0;
    for (const Record* r : list_.cases()) {
      ++cases;
      failed += is_failure(r->status);
    }
    table.caption += "; of all " + std::to_string(cases) + " cases of this page, " +
                     std::to_string(failed) + " failed";
    answer_.add(std::move(table));
  }

  /// Of what every solver that ran anything here ran.
  static std::vector<Count> shared_counts(const std::vector<Asked>& here) {
    std::vector<Count> counts(here.size());
    for (std::size_t i = 0; i < here.size(); ++i)
      for (const auto& [asked, record] : here[i])
        if (std::ranges::all_of(here, [&, &asked = asked](const Asked& other) {
              return other.empty() || other.contains(asked);
            }))
          counts[i].add(*record);
    return counts;
  }

  std::vector<Cell> failure_row(Cell head, const std::vector<Count>& counts) {
    std::vector<Cell> row{std::move(head)};
    for (const Count& count : counts) {
      const std::string kinds = join(count.kinds, ", ", [](const auto& kind) {
        return std::to_string(kind.second) + " " + kind.first;
      });
      row.push_back(count.cases == 0 ? why_none(nullptr)
                                     : Cell(count.failed)
                                           .with("of " + std::to_string(count.cases) +
                                                 (kinds.empty() ? "" : ": " + kinds)));
      if (!count.key.empty()) row.back().key = list_.key(count.key);
    }
    mark_least(row, 0);
    return row;
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
