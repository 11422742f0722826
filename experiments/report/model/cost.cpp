#include <algorithm>
#include <cmath>
#include <limits>
#include <list>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/model/parts.hpp"
#include "experiments/report/questions/costs.hpp"
#include "experiments/report/questions/winners.hpp"
#include "experiments/timing/cheapest.hpp"
#include "experiments/timing/profile.hpp"

namespace taut::report {

namespace {

/// Costs on one scene.
struct CostScene {
  JudgedScene timed;
  CaseList& refs;

  /// Cell of a case. Its note has the setting and the values of motion, since a small strain may
  /// come from cloth that is not where it should be.
  Cell of(std::size_t at, Cell cell) const {
    const Record& r = timed.bench.cases[at].record;
    const Label label = setting_label(timed.bench, at);
    cell.note = label.text();
    cell.terms = label.terms();
    cell.key = refs.key(r);
    if (timed.is_upper_bound(at)) cell.note += kUpperBound;
    for (const ValueSpec* value : values_with_role()) {
      const Quantity q = quantity(value->name);
      if (const double v = value_of(r, value->name);
          value->role == Role::motion && std::isfinite(v))
        cell.note += ", " + q.title + " " + q.text(v);
    }
    return cell;
  }
  std::vector<Column> columns(Column first, const Unit& unit) const {
    std::vector<Column> all{std::move(first)};
    for (const std::string& solver : solvers_of(timed.bench))
      all.emplace_back(solver, solver_title(solver), unit, 2);
    return all;
  }
};

Table levels_table(const CostScene& scene, const WinnerRow& winners) {
  const SceneBench& bench = scene.timed.bench;
  const Quantity q = quantity(scene.timed.metric);
  const CaseSpec spec =
      bench.cases.empty() ? CaseSpec{bench.scene, {}, {}} : bench.cases.front().record.spec;
  std::string again = "taut advise " + spec.scene + " --error 1%";
  for (const SceneSetting& one : spec.settings) again += " --set '" + one.text() + "'";
  Table table{
      "cost-levels-" + slug(bench.scene),
      "CPU time of an error, per simulated second",
      scene.columns(Column("level", q.title, q.unit, 1), quantity(kCpuPerSecond).unit),
      {},
      "95\u00A0% interval and setting of the cheapest that was timed. More accurate ones are "
      "searched by: " +
          again};
  for (std::size_t k = 0; k < std::size(kErrorLevels); ++k) {
    const double level = kErrorLevels[k];
    const WinnerCell& winner = winners.cells[k];
    std::vector<Cell> row{level};
    for (const std::string& solver : solvers_of(bench)) {
      const auto at = scene.timed.best({.error = level}, solver);
      if (!at) {
        const std::string words =
            bench.searched_to_the_end(solver) ? "never reached" : "not reached";
        const Cell why = scene.timed.why_not({.error = level}, solver);
        row.push_back(Cell::lacking(why.state, words).with(why.note));
        continue;
      }
      row.push_back(scene.of(*at, Cell(scene.timed.candidates[*at].cost)));
      row.back().best = winner.won() && winner.cheapest[0].solver == solver;
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// "1 of XPBD, 3 of PD": number of problems that even the cheapest tried setting of a solver
/// solves.
std::string upper_bounds(const std::vector<SceneBench>& scenes) {
  std::map<std::string, int> bounds;
  for (const SceneBench& scene : scenes) {
    const JudgedScene timed(scene, kVerdict);
    for (const double level : kErrorLevels)
      for (const std::size_t at : timed.best_of_each({.error = level}))
        bounds[solver_title(timed.candidates[at].solver)] += timed.is_upper_bound(at);
  }
  std::erase_if(bounds, [](const auto& one) { return one.second == 0; });
  return join(bounds, ", ",
              [](const auto& one) { return std::to_string(one.second) + " of " + one.first; });
}

/// A table of Dolan and More's performance profiles at a few factors.
Table profile_table(const std::vector<SceneBench>& scenes) {
  const std::vector<PerformanceProfile> profiles =
      performance_profiles(scenes, kVerdict, kErrorLevels);
  const std::size_t problems = profiles.empty() ? 0 : profiles.front().ratios.size();
  Table table{"cost-profiles",
              "How often each solver is within a factor of the cheapest",
              {Column("solver")},
              {},
              std::to_string(problems) +
                  " problems: an error to be reached on a scene. A cell is the share of them that "
                  "the solver solves within this factor of the cheapest solver's CPU time, by the "
                  "best of all its settings that were timed. Between two rows of many, the order "
                  "depends on who else is there; pairs are compared in the map."};
  if (const std::string bounds = upper_bounds(scenes); !bounds.empty())
    table.caption +=
        " Problems that a solver's cheapest setting already solves, so that it may rank higher: " +
        bounds + ".";
  constexpr std::pair<double, const char*> kFactors[] = {
      {1, "the cheapest"}, {1.5, "within 1.5 ×"},
      {2, "within 2 ×"},   {4, "within 4 ×"},
      {10, "within 10 ×"}, {std::numeric_limits<double>::max(), "at any cost"}};
  for (const auto& [factor, heading] : kFactors)
    table.columns.emplace_back(heading, heading, kShare);
  for (const PerformanceProfile& profile : profiles) {
    if (problems == 0) break;
    std::vector<Cell> row{solver_title(profile.solver)};
    for (const auto& [factor, heading] : kFactors) row.emplace_back(profile.share(factor));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Json json_of_cost(const ReportInput& input, CaseList& refs, DrawnCharts& drawn, Answer& tables) {
  const StudyBench& study = *input.bench;
  const WinnerMap winners = winners_of(input, refs);
  Json cost{{"machine", study.machine}};
  refs.use(kCpuPerSecond);
  refs.use(kCpuPerStep);
  std::vector<Chart> charts;
  std::list<std::vector<Record>> kept;  // charts point into these
  for (const SceneBench& bench : study.scenes) {
    const std::vector<Record>& records = kept.emplace_back(StudyBench{"", "", {bench}}.records());
    const CostScene scene{JudgedScene(bench), refs};
    Json one{{"scene", bench.scene}};
    try {
      charts.push_back(cost_chart(bench, records));
      one["charts"].push_back(charts.back().id);
    } catch (const InputError&) {
      // Nothing completed, which the tables report.
    }
    add_table(one, levels_table(scene, winners.rows[kept.size() - 1]), tables);
    cost["scenes"].push_back(std::move(one));
  }
  for (const Figure& figure : figures_of(charts)) add_figure(drawn, "cost", figure, refs);
  add_table(cost, profile_table(study.scenes), tables);
  return cost;
}

}  // namespace taut::report
