// Questions of costs: every setting was timed in turns with the others of its scene.
#include "experiments/report/questions/costs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/model/text.hpp"
#include "experiments/report/questions/links.hpp"
#include "experiments/report/questions/rows.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/timing/recommendation.hpp"
#include "experiments/timing/way.hpp"

namespace taut::report {

SceneBench with_shared_parameters(SceneBench bench) {
  std::map<std::string, std::map<std::string, std::string>> params;
  for (const BenchedCase& c : bench.cases) params[c.record.solver] = c.record.params;
  std::erase_if(bench.cases, [&](const BenchedCase& c) {
    return std::ranges::any_of(params, [&](const auto& other) {
      return other.first != c.record.solver && !extras(c.record, other.second).empty();
    });
  });
  return bench;
}

std::string setting_text(const SceneBench& bench, std::size_t at, std::vector<std::string> beside) {
  Records records;
  for (const BenchedCase& c : bench.cases) records.push_back(&c.record);
  const Record& one = bench.cases[at].record;
  const std::string order = link_order(one);
  if (!order.empty()) beside.push_back(link_order_parameter(one.solver));
  std::string label = SettingLabels(records).of(one, beside);
  if (label.empty()) label = work_of(one).text();
  return label + (order.empty() ? "" : ", " + order);
}

std::optional<Cell> only_uncounted(const std::vector<Candidate>& candidates,
                                   const std::string& solver, double error,
                                   const std::string& words) {
  for (const Candidate& one : candidates)
    if (one.solver == solver && one.error <= error && (one.hardly_moves || one.not_accepted))
      return Cell::lacking(one.hardly_moves ? Cell::State::hardly_moves : Cell::State::none, words)
          .with(one.failure);
  return {};
}

bool is_upper_bound(const SceneBench& bench, const std::vector<Candidate>& candidates,
                    std::size_t at) {
  const auto work = [&](std::size_t i) {
    const Work one = work_of(bench.cases[i].record);
    return std::max(1, one.substeps) * std::max(1, one.sweeps);
  };
  if (work(at) == 1) return false;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i].solver != candidates[at].solver) continue;
    const bool timed = bench.cases[i].stable();  // a cheaper one may have failed
    if (timed ? candidates[i].cost.mid < candidates[at].cost.mid : work(i) < work(at)) return false;
  }
  return true;
}

namespace {

/// One scene of a bench. The candidates are cached, since each of their intervals is a bootstrap.
struct Timed {
  SceneBench bench;
  std::vector<Candidate> candidates;

  std::optional<std::size_t> best(const Target& target, const std::string& solver) const {
    return best_for(target, candidates, solver);
  }
  bool has(const std::string& solver) const {
    return std::ranges::find(candidates, solver, &Candidate::solver) != candidates.end();
  }
  bool bounds(std::size_t at) const { return is_upper_bound(bench, candidates, at); }
  /// The cell of a solver that misses the error: `words`, and how near it came ("at best 0.12 %").
  Cell not_reached(const std::string& words, const std::string& solver) const {
    if (!has(solver)) return Cell::lacking(Cell::State::not_run, "not timed");
    if (const auto uncounted = only_uncounted(candidates, solver, kPricedError, words))
      return *uncounted;
    const Cell cell = Cell::lacking(Cell::State::none, words);
    const auto at = best({.budget = std::numeric_limits<double>::infinity()}, solver);
    if (!at) return cell.with("no case completed");
    return cell.with(
        "at best " + quantity(kErrorMetric).text(candidates[*at].error) +
        (bench.searched_to_the_end(solver) ? ", to the end of its accuracy parameters" : ""));
  }
  /// The first cell of its row.
  Cell head() const {
    return Cell(bench.scene)
        .of_scene(bench.cases.empty() ? bench.scene : bench.cases.front().record.scene);
  }
};

using Chosen = std::vector<std::optional<std::size_t>>;  ///< case of each solver

/// Marks the cheapest if it is distinguishable from all others. Nothing is marked against an upper
/// bound; `bounds`: which costs are one.
void mark_cheapest(std::vector<Cell>& row, const std::vector<std::vector<Interval>>& over,
                   const std::vector<bool>& bounds, const Interval& control) {
  for (std::size_t i = 0; i < over.size(); ++i) {
    bool any = false, cheapest = true;
    for (std::size_t j = 0; j < over.size(); ++j) {
      if (i == j || over[i][j].mid == 0) continue;
      any = true;
      cheapest =
          cheapest && !bounds[j] && over[i][j].mid < 1 && is_difference(judge(over[i][j], control));
    }
    row[i + 1].best = any && cheapest;
  }
}

class Costs {
 public:
  Costs(const ReportInput& input, const std::vector<Column>& solvers, CaseList& list)
      : solvers_(solvers), list_(list) {
    for (const SceneBench& bench : input.bench->scenes) {
      const SceneBench shared = with_shared_parameters(bench);
      all_.push_back({bench, bench.candidates(kErrorMetric)});
      shared_.push_back({shared, shared.candidates(kErrorMetric)});
    }
    list.use(kErrorMetric);
    list.use("cpu.per_second");
  }

  void add_to(Answer& answer) {
    add_price(answer);
    add_setting(answer);
    add_equal_cost(answer);
  }

 private:
  Cell cell_of(const Timed& scene, std::size_t at, Cell cell) {
    cell.note = setting_text(scene.bench, at);
    cell.key = list_.key(scene.bench.cases[at].record);
    return cell;
  }

  /// The least budget within which every solver has a setting on every scene, else the largest.
  double common_budget() const {
    for (const double budget : kFrameBudgets)
      if (std::ranges::all_of(shared_, [&](const Timed& scene) {
            return std::ranges::all_of(solvers_of(scene.bench), [&](const std::string& solver) {
              return scene.best({.budget = budget / kFrame}, solver).has_value();
            });
          }))
        return budget;
    return std::end(kFrameBudgets)[-1];
  }

  void add_equal_cost(Answer& answer) {
    const Quantity q = quantity(kErrorMetric);
    const double budget = common_budget(), floor = find_value(kErrorMetric).second->negligible;
    Table table{"equal_cost",
                capitalised(q.title) + " at equal cost",
                columns_of(solvers_, q.unit),
                {},
                std::string(to_string(q.window)) + "; least of the settings timed within " +
                    significant(1e3 * budget, 2) + "\u00A0ms of CPU time a frame of 1/60\u00A0s (" +
                    quantity("cpu.per_second").text(budget / kFrame) + " per simulated second), " +
                    kWithoutExtras + orders()};
    for (const Timed& scene : shared_) {
      std::vector<Cell> row{scene.head()};
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

  /// Ratios of the chosen cases on one scene; mid 0: not both were chosen.
  std::vector<std::vector<Interval>> ratios_of(const Timed& scene, const Chosen& chosen) const {
    std::vector<std::vector<Interval>> over(chosen.size(), std::vector<Interval>(chosen.size()));
    for (std::size_t i = 0; i < chosen.size(); ++i)
      for (std::size_t j = 0; j < chosen.size(); ++j)
        if (i != j && chosen[i] && chosen[j])
          over[i][j] = scene.bench.ratio(*chosen[i], *chosen[j]).value_or(Interval{});
    return over;
  }

  static std::vector<bool> bounds_of(const Timed& scene, const Chosen& chosen) {
    std::vector<bool> bounds;
    for (const auto& at : chosen) bounds.push_back(at && scene.bounds(*at));
    return bounds;
  }

  void add_price(Answer& answer) {
    Table table{"price",
                "CPU time of " + priced(),
                columns_of(solvers_, quantity("cpu.per_second").unit),
                {},
                "per simulated second, 95\u00A0% interval; each at its cheapest setting timed, " +
                    std::string(kWithoutExtras) + orders()};
    std::vector<std::vector<std::vector<Interval>>> ratios;
    std::vector<std::vector<bool>> bounds;
    for (const Timed& scene : shared_) {
      std::vector<Cell> row{scene.head()};
      Chosen own;
      for (const Column& solver : solvers_) {
        own.push_back(scene.best({.error = kPricedError}, solver.name));
        row.push_back(own.back()
                          ? cell_of(scene, *own.back(), Cell(scene.candidates[*own.back()].cost))
                          : scene.not_reached("not reached", solver.name));
        if (own.back() && scene.bounds(*own.back())) row.back().note += kUpperBound;
      }
      mark_cheapest(row, ratios.emplace_back(ratios_of(scene, own)),
                    bounds.emplace_back(bounds_of(scene, own)), scene.bench.control);
      table.rows.push_back(std::move(row));
    }
    const auto any = [](const std::vector<bool>& of_row) {
      return std::ranges::count(of_row, true) > 0;
    };
    if (std::ranges::any_of(bounds, any)) table.caption += std::string("; ") + kUpperBoundMeans;
    table.rows.push_back(mean_price(table, ratios, bounds));
    answer.add(std::move(table));
  }

  /// The order of links of each solver; "": none has one.
  std::string orders() const {
    std::vector<SceneBench> scenes;
    for (const Timed& scene : shared_) scenes.push_back(scene.bench);
    const std::string all = link_orders(scenes);
    return all.empty() ? "" : "; links in each solver's own order: " + all;
  }

  static double noise(const std::vector<Timed>& scenes) {
    double most = 0;
    for (const Timed& scene : scenes) most = std::max(most, spread(scene.bench.control));
    return most;
  }
  Interval control() const { return {1 / (1 + noise(shared_)), 1, 1 + noise(shared_)}; }

  std::vector<Cell> mean_price(const Table& table,
                               const std::vector<std::vector<std::vector<Interval>>>& ratios,
                               const std::vector<std::vector<bool>>& bounds) {
    const Common common = common_of(table, 0);
    std::vector<Cell> last = last_row(table, common, "mean of", [&](std::size_t c) {
      std::vector<Interval> costs;
      for (const std::size_t r : common.rows)
        costs.push_back(std::get<Interval>(table.rows[r][c].value));
      return Cell(geometric_mean(costs));
    });
    const std::size_t n = solvers_.size();
    std::vector<std::vector<Interval>> over(n, std::vector<Interval>(n));
    std::vector<bool> bounded(n, false);
    for (const std::size_t c : common.columns) {
      const std::size_t i = c - 1;
      for (const std::size_t r : common.rows) bounded[i] = bounded[i] || bounds[r][i];
      if (bounded[i] && common.rows.size() > 1) last[c].note = "at most";
      for (std::size_t j = 0; j < n && !common.rows.empty(); ++j) {
        std::vector<Interval> both;
        for (const std::size_t r : common.rows)
          if (ratios[r][i][j].mid > 0) both.push_back(ratios[r][i][j]);
        if (both.size() == common.rows.size()) over[i][j] = geometric_mean(both);
      }
    }
    mark_cheapest(last, over, bounded, control());
    return last;
  }

  static std::string priced() {
    const Quantity q = quantity(kErrorMetric);
    return q.text(kPricedError, 1) + " " + q.title;
  }

  /// The recommended setting of each solver: it reaches the error on most scenes; ties go to the
  /// cheapest; accelerators included.
  void add_setting(Answer& answer) {
    Table table{"setting",
                "Recommended setting",
                columns_of(solvers_, kNumber),
                {},
                "the cheapest timed that reaches " + priced() +
                    ", accelerators that only one solver has included, and its CPU time per "
                    "simulated second; of all scenes: on most of them, then least geometric mean"};
    for (const Timed& scene : all_) {
      std::vector<Cell> row{scene.head()};
      Chosen chosen;
      for (const Column& solver : solvers_) {
        chosen.push_back(scene.best({.error = kPricedError}, solver.name));
        row.push_back(chosen.back() ? setting_cell(scene, *chosen.back(),
                                                   scene.candidates[*chosen.back()].cost.mid,
                                                   scene.bounds(*chosen.back()), "")
                                    : scene.not_reached("none", solver.name));
      }
      mark_cheapest(row, ratios_of(scene, chosen), bounds_of(scene, chosen), scene.bench.control);
      table.rows.push_back(std::move(row));
    }
    table.rows.push_back(overall_setting(table));
    answer.add(std::move(table));
  }

  Cell setting_cell(const Timed& scene, std::size_t at, double cost, bool bound,
                    const std::string& on) {
    Cell cell(setting_text(scene.bench, at));
    cell.key = list_.key(scene.bench.cases[at].record);
    return cell.with((bound ? "at most " : "") + quantity("cpu.per_second").text(cost) + on);
  }

  /// A setting of a solver with the cases that reach the error, by scene.
  struct Reached {
    std::map<std::size_t, std::size_t> cases;
    double mean_log_cost(const std::vector<Timed>& all) const {
      double logs = 0;
      for (const auto& [scene, at] : cases) logs += std::log(all[scene].candidates[at].cost.mid);
      return logs / static_cast<double>(cases.size());
    }
  };
  /// The solver's setting that reaches the error on most scenes; ties go to the cheapest. Without
  /// cases: none reaches it.
  Reached most_reaching(const std::string& solver) const {
    std::map<std::string, Reached> settings;
    for (std::size_t k = 0; k < all_.size(); ++k)
      for (std::size_t i = 0; i < all_[k].candidates.size(); ++i)
        if (const Candidate& one = all_[k].candidates[i];
            one.solver == solver && Target{.error = kPricedError}.meets(one))
          settings[one.setting].cases[k] = i;
    const auto best = std::ranges::max_element(settings, {}, [&](const auto& one) {
      return std::pair(one.second.cases.size(), -one.second.mean_log_cost(all_));
    });
    return best == settings.end() ? Reached{} : best->second;
  }

  std::vector<Cell> overall_setting(const Table& table) {
    const std::string of = " of " + std::to_string(all_.size());
    std::vector<Cell> last{all_.size() == 1 ? table.rows[0][0] : Cell("on most" + of + " scenes")};
    std::vector<Reached> reached;
    std::vector<bool> bounds;
    for (std::size_t s = 0; s < solvers_.size(); ++s) {
      const Reached& own = reached.emplace_back(most_reaching(solvers_[s].name));
      bounds.push_back(std::ranges::any_of(
          own.cases, [&](const auto& one) { return all_[one.first].bounds(one.second); }));
      if (own.cases.empty()) {
        last.push_back(why_empty(table, s + 1));
        continue;
      }
      const auto& [scene, at] = *own.cases.begin();
      last.push_back(
          setting_cell(all_[scene], at, std::exp(own.mean_log_cost(all_)), bounds.back(),
                       all_.size() == 1 ? "" : ", " + std::to_string(own.cases.size()) + of));
    }
    if (const auto over = ratios_of(reached))
      mark_cheapest(last, *over, bounds, {1 / (1 + noise(all_)), 1, 1 + noise(all_)});
    return last;
  }

  /// Means over the same scenes; nothing if the solvers reach the error on different ones.
  std::optional<std::vector<std::vector<Interval>>> ratios_of(
      const std::vector<Reached>& reached) const {
    const std::size_t n = reached.size();
    std::vector<std::vector<Interval>> over(n, std::vector<Interval>(n));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        const auto &a = reached[i].cases, &b = reached[j].cases;
        if (i == j || a.empty() || b.empty()) continue;
        if (!std::ranges::equal(
                a, b, {}, [](const auto& one) { return one.first; },
                [](const auto& one) { return one.first; }))
          return std::nullopt;
        std::vector<Interval> both;
        for (const auto& [scene, at] : a)
          if (const auto ratio = all_[scene].bench.ratio(at, b.at(scene))) both.push_back(*ratio);
        if (both.size() != a.size()) return std::nullopt;
        over[i][j] = geometric_mean(both);
      }
    return over;
  }

  const std::vector<Column>& solvers_;
  CaseList& list_;
  std::vector<Timed> all_, shared_;
};

}  // namespace

void add_costs(Answer& answer, const ReportInput& input, const std::vector<Column>& solvers,
               CaseList& list) {
  if (input.bench) Costs(input, solvers, list).add_to(answer);
}

}  // namespace taut::report
