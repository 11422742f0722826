// Questions of costs: every setting was timed in turns with the others of its scene.
#include "experiments/report/questions/costs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/report/questions/links.hpp"
#include "experiments/report/questions/rows.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/timing/recommendation.hpp"

namespace taut::report {

Label setting_label(const SceneBench& bench, std::size_t at, std::vector<std::string> beside) {
  Records records;
  for (const BenchedCase& c : bench.cases) records.push_back(&c.record);
  const Record& one = bench.cases[at].record;
  const std::string order = link_order(one);
  if (!order.empty()) beside.push_back(link_order_parameter(one.solver));
  Label label = SettingLabels(records).parts(one, beside);
  if (label.empty()) label.push_back(label_part(work_of(one)));
  if (!order.empty()) label.push_back({order, order});
  return label;
}

namespace {

/// The cell of a solver that misses the error: `words`, and why (JudgedScene::why_not).
Cell not_reached(const JudgedScene& scene, const std::string& words, const std::string& solver) {
  const Cell why = scene.why_not({.error = kPricedError}, solver);
  if (why.state == Cell::State::not_run) return Cell::lacking(why.state, "not timed");
  return Cell::lacking(why.state, words)
      .with(why.note + (scene.bench.searched_to_the_end(solver)
                            ? ", to the end of its accuracy parameters"
                            : ""));
}

/// The first cell of the scene's row.
Cell head_of(const SceneBench& bench) {
  return Cell(bench.scene + (bench.deciding_metric() == kVerdict ? "" : " (by strain alone)"))
      .of_scene(bench.cases.empty() ? bench.scene : bench.cases.front().record.scene);
}

using Chosen = std::vector<std::optional<std::size_t>>;  ///< case of each solver

/// Marks the cheapest of these columns if all others are dearer (Cheapest::is_told).
void mark_cheapest(std::vector<Cell>& row, const std::vector<Cost>& costs, const RatioOf& ratio,
                   const Interval& control) {
  if (costs.empty()) return;
  const Cheapest found = cheapest_of(costs, ratio, control);
  row[found.at + 1].best = found.is_told();
}
void mark_cheapest(std::vector<Cell>& row, const JudgedScene& scene, const Chosen& chosen) {
  std::vector<Cost> costs;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if (const auto at = chosen[i])
      costs.push_back({i, scene.candidates[*at].cost.mid, scene.is_upper_bound(*at)});
  mark_cheapest(
      row, costs,
      [&](std::size_t i, std::size_t j) { return scene.bench.ratio(*chosen[i], *chosen[j]); },
      scene.bench.control);
}

/// Geometric mean of ratios; nothing: one of them is missing, or there is no ratio.
std::optional<Interval> mean_ratio(const std::vector<std::optional<Interval>>& ratios) {
  if (ratios.empty() || !std::ranges::all_of(ratios, &std::optional<Interval>::has_value))
    return {};
  std::vector<Interval> all;
  for (const auto& ratio : ratios) all.push_back(*ratio);
  return geometric_mean(all);
}

class Costs {
 public:
  Costs(const ReportInput& input, const std::vector<Column>& solvers, CaseList& list)
      : solvers_(solvers), list_(list) {
    for (const SceneBench& bench : input.bench->scenes) {
      scenes_.emplace_back(bench);
      list.use(scenes_.back().metric);
    }
    list.use(kCpuPerSecond);
  }

  void add_to(Answer& answer) {
    add_price(answer);
    add_setting(answer);
    add_default(answer);
    add_equal_cost(answer);
  }

 private:
  Cell cell_of(const JudgedScene& scene, std::size_t at, Cell cell) {
    const Label label = setting_label(scene.bench, at);
    cell.note = label.text();
    cell.terms = label.terms();
    cell.key = list_.key(scene.bench.cases[at].record);
    return cell;
  }

  /// The least budget within which every solver has a setting on every scene, else the largest.
  double common_budget() const {
    for (const double budget : kFrameBudgets)
      if (std::ranges::all_of(scenes_, [&](const JudgedScene& scene) {
            return std::ranges::all_of(solvers_of(scene.bench), [&](const std::string& solver) {
              return scene.best({.budget = budget / kFrame}, solver).has_value();
            });
          }))
        return budget;
    return std::end(kFrameBudgets)[-1];
  }

  void add_equal_cost(Answer& answer) {
    const Quantity q = quantity(kVerdict);
    const double budget = common_budget(), floor = kErrorLevels[std::size(kErrorLevels) - 1];
    Table table{"equal_cost",
                "Error at equal cost",
                columns_of(solvers_, q.unit),
                {},
                "least of the settings timed within " + significant(1e3 * budget, 2) +
                    "\u00A0ms of CPU time a frame of 1/" + number_text(1 / kFrame) + "\u00A0s (" +
                    quantity(kCpuPerSecond).text(budget / kFrame) + " per simulated second)" +
                    orders()};
    for (const JudgedScene& scene : scenes_) {
      std::vector<Cell> row{head_of(scene.bench)};
      for (const Column& solver : solvers_) {
        const auto at = scene.best({.budget = budget / kFrame}, solver.name);
        row.push_back(at ? cell_of(scene, *at, Cell(scene.candidates[*at].error))
                      : scene.has(solver.name)
                          ? Cell::lacking(Cell::State::none, "nothing that cheap")
                          : Cell::lacking(Cell::State::not_run, "not timed"));
      }
      mark_least(row, floor);
      table.rows.push_back(std::move(row));
    }
    const Common common = common_of(table, floor);
    std::vector<Cell> last = last_row(table, common, "mean of", [&](std::size_t c) {
      double logs = 0;
      for (const std::size_t r : common.rows)
        logs += std::log(std::max(table.rows[r][c].number(), floor));
      return Cell(std::exp(logs / static_cast<double>(common.rows.size())));
    });
    mark_least(last, floor);
    table.rows.push_back(std::move(last));
    answer.add(std::move(table));
  }

  void add_price(Answer& answer) {
    Table table{
        kPrice,
        "CPU time of " + priced(),
        columns_of(solvers_, quantity(kCpuPerSecond).unit),
        {},
        "per simulated second, 95\u00A0% interval; each at its cheapest setting timed" + orders()};
    std::vector<Chosen> chosen;  // of each scene
    bool any_bound = false;
    for (const JudgedScene& scene : scenes_) {
      std::vector<Cell> row{head_of(scene.bench)};
      Chosen& own = chosen.emplace_back();
      for (const Column& solver : solvers_) {
        own.push_back(scene.best({.error = kPricedError}, solver.name));
        row.push_back(own.back()
                          ? cell_of(scene, *own.back(), Cell(scene.candidates[*own.back()].cost))
                          : not_reached(scene, "not reached", solver.name));
        if (!own.back() || !scene.is_upper_bound(*own.back())) continue;
        row.back().note += kUpperBound;
        any_bound = true;
      }
      mark_cheapest(row, scene, own);
      table.rows.push_back(std::move(row));
    }
    if (any_bound) table.caption += std::string("; ") + kUpperBoundMeans;
    table.rows.push_back(mean_price(table, chosen));
    answer.add(std::move(table));
  }

  /// The order of links of each solver; "": none has one.
  std::string orders() const {
    std::vector<SceneBench> scenes;
    for (const JudgedScene& scene : scenes_) scenes.push_back(scene.bench);
    const std::string all = link_orders(scenes);
    return all.empty() ? "" : "; links in each solver's own order: " + all;
  }

  static double noise(const std::vector<JudgedScene>& scenes) {
    double most = 0;
    for (const JudgedScene& scene : scenes) most = std::max(most, spread(scene.bench.control));
    return most;
  }
  static Interval control(const std::vector<JudgedScene>& scenes) {
    return {1 / (1 + noise(scenes)), 1, 1 + noise(scenes)};
  }

  /// `chosen`: the cases in the rows of the table.
  std::vector<Cell> mean_price(const Table& table, const std::vector<Chosen>& chosen) {
    const Common common = common_of(table, 0);
    std::vector<Cell> last = last_row(table, common, "mean of", [&](std::size_t c) {
      std::vector<Interval> costs;
      for (const std::size_t r : common.rows)
        costs.push_back(std::get<Interval>(table.rows[r][c].value));
      return Cell(geometric_mean(costs));
    });
    if (common.rows.empty()) return last;
    std::vector<Cost> costs;
    for (const std::size_t c : common.columns) {
      const bool is_bound = std::ranges::any_of(
          common.rows, [&](std::size_t r) { return scenes_[r].is_upper_bound(*chosen[r][c - 1]); });
      if (is_bound && common.rows.size() > 1) last[c].note = "at most";
      costs.push_back({c - 1, last[c].number(), is_bound});
    }
    const auto ratio = [&](std::size_t i, std::size_t j) {
      std::vector<std::optional<Interval>> all;
      for (const std::size_t r : common.rows)
        all.push_back(scenes_[r].bench.ratio(*chosen[r][i], *chosen[r][j]));
      return mean_ratio(all);
    };
    mark_cheapest(last, costs, ratio, control(scenes_));
    return last;
  }

  static std::string priced() {
    const Quantity q = quantity(kVerdict);
    return q.text(kPricedError, 1) + " error";
  }

  /// The recommended setting of each solver: it reaches the error on most scenes; ties go to the
  /// cheapest; accelerators included.
  void add_setting(Answer& answer) {
    Table table{"setting",
                "Recommended setting",
                columns_of(solvers_, kNumber),
                {},
                "the cheapest timed that reaches " + priced() +
                    ", and its CPU time per "
                    "simulated second; of all scenes: on most of them, then least geometric mean"};
    for (const JudgedScene& scene : scenes_) {
      std::vector<Cell> row{head_of(scene.bench)};
      Chosen chosen;
      for (const Column& solver : solvers_) {
        chosen.push_back(scene.best({.error = kPricedError}, solver.name));
        row.push_back(chosen.back() ? setting_cell(scene, *chosen.back(),
                                                   scene.candidates[*chosen.back()].cost.mid,
                                                   scene.is_upper_bound(*chosen.back()), "")
                                    : not_reached(scene, "none", solver.name));
      }
      mark_cheapest(row, scene, chosen);
      table.rows.push_back(std::move(row));
    }
    table.rows.push_back(overall_setting(table));
    answer.add(std::move(table));
  }

  /// What each solver does as it comes: its defaults on every scene, beside the settings above that
  /// were searched scene by scene.
  void add_default(Answer& answer) {
    const Quantity q = quantity(kVerdict);
    Table table{"default",
                "Error at the default setting",
                columns_of(solvers_, q.unit),
                {},
                "one setting on all scenes, nothing searched, with its CPU time per simulated "
                "second; costs differ, so none is marked"};
    for (const JudgedScene& scene : scenes_) {
      std::vector<Cell> row{head_of(scene.bench)};
      for (const Column& solver : solvers_) {
        const auto& cases = scene.bench.cases;
        const auto found = std::ranges::find_if(cases, [&](const BenchedCase& c) {
          return c.record.solver == solver.name &&
                 parse_solver(c.record.spec.solver).brief() == solver.name;
        });
        if (found == cases.end()) {
          row.push_back(Cell::lacking(Cell::State::not_run, "not timed"));
          continue;
        }
        const Record& r = found->record;
        const double error = completed(r.status) ? error_of(r, kVerdict) : std::nan("");
        row.push_back(std::isfinite(error) ? Cell(error) : why_none(&r));
        row.back().key = list_.key(r);
        const double cost =
            scene.candidates[static_cast<std::size_t>(found - cases.begin())].cost.mid;
        if (std::isfinite(cost)) row.back().note = quantity(kCpuPerSecond).text(cost);
      }
      if (std::ranges::any_of(row, [](const Cell& c) { return std::isfinite(c.number()); }))
        table.rows.push_back(std::move(row));
    }
    if (table.rows.empty()) return;
    const Common common = common_of(table, 0);
    table.rows.push_back(last_row(table, common, "mean of", [&](std::size_t c) {
      std::vector<Interval> errors;
      for (const std::size_t r : common.rows) {
        const double error = table.rows[r][c].number();
        errors.push_back({error, error, error});
      }
      return Cell(geometric_mean(errors).mid);
    }));
    answer.add(std::move(table));
  }

  Cell setting_cell(const JudgedScene& scene, std::size_t at, double cost, bool bound,
                    const std::string& on) {
    Cell cell(setting_label(scene.bench, at).text());
    cell.key = list_.key(scene.bench.cases[at].record);
    return cell.with((bound ? "at most " : "") + quantity(kCpuPerSecond).text(cost) + on);
  }

  /// A setting of a solver with the cases that reach the error, by scene.
  struct Reached {
    using Case = std::pair<const std::size_t, std::size_t>;
    std::map<std::size_t, std::size_t> cases;
    double mean_log_cost(const std::vector<JudgedScene>& all) const {
      double logs = 0;
      for (const auto& [scene, at] : cases) logs += std::log(all[scene].candidates[at].cost.mid);
      return logs / static_cast<double>(cases.size());
    }
    bool is_of_same_scenes(const Reached& other) const {
      return std::ranges::equal(cases, other.cases, {}, &Case::first, &Case::first);
    }
  };
  /// The solver's setting that reaches the error on most scenes; ties go to the cheapest. Without
  /// cases: none reaches it.
  Reached most_reaching(const std::string& solver) const {
    std::map<std::string, Reached> settings;
    for (std::size_t k = 0; k < scenes_.size(); ++k)
      for (std::size_t i = 0; i < scenes_[k].candidates.size(); ++i)
        if (const Candidate& one = scenes_[k].candidates[i];
            one.solver == solver && Target{.error = kPricedError}.meets(one))
          settings[one.setting].cases[k] = i;
    const auto best = std::ranges::max_element(settings, {}, [&](const auto& one) {
      return std::pair(one.second.cases.size(), -one.second.mean_log_cost(scenes_));
    });
    return best == settings.end() ? Reached{} : best->second;
  }

  std::vector<Cell> overall_setting(const Table& table) {
    const std::string of = " of " + std::to_string(scenes_.size());
    std::vector<Cell> last{scenes_.size() == 1 ? table.rows[0][0]
                                               : Cell("on most" + of + " scenes")};
    std::vector<Reached> reached;
    std::vector<Cost> costs;
    for (std::size_t s = 0; s < solvers_.size(); ++s) {
      const Reached& own = reached.emplace_back(most_reaching(solvers_[s].name));
      if (own.cases.empty()) {
        last.push_back(why_empty(table, s + 1));
        continue;
      }
      const bool is_bound = std::ranges::any_of(own.cases, [&](const auto& one) {
        return scenes_[one.first].is_upper_bound(one.second);
      });
      costs.push_back({s, std::exp(own.mean_log_cost(scenes_)), is_bound});
      const auto& [scene, at] = *own.cases.begin();
      last.push_back(
          setting_cell(scenes_[scene], at, costs.back().mid, is_bound,
                       scenes_.size() == 1 ? "" : ", " + std::to_string(own.cases.size()) + of));
    }
    const auto alike = [&](const Cost& one) {
      return reached[one.at].is_of_same_scenes(reached[costs.front().at]);
    };
    if (!std::ranges::all_of(costs, alike)) return last;
    const auto ratio = [&](std::size_t i, std::size_t j) {
      std::vector<std::optional<Interval>> all;
      for (const auto& [scene, at] : reached[i].cases)
        all.push_back(scenes_[scene].bench.ratio(at, reached[j].cases.at(scene)));
      return mean_ratio(all);
    };
    mark_cheapest(last, costs, ratio, control(scenes_));
    return last;
  }

  const std::vector<Column>& solvers_;
  CaseList& list_;
  std::vector<JudgedScene> scenes_;
};

}  // namespace

void add_costs(Answer& answer, const ReportInput& input, const std::vector<Column>& solvers,
               CaseList& list) {
  if (input.bench) Costs(input, solvers, list).add_to(answer);
}

}  // namespace taut::report
