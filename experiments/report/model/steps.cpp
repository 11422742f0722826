// Inside one step: how near each solver's iterations come to the exact one.
#include <algorithm>
#include <cmath>
#include <list>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/report/chart/one_step.hpp"
#include "experiments/report/model/parts.hpp"
#include "experiments/system/distinct.hpp"

namespace taut::report {

namespace {

constexpr int kLooked = 16;  ///< iterations, as in the comparison at equal work

/// The first row of this solver for which `holds`; nullptr: none.
template <class Holds>
const std::vector<Cell>* first_of(const Table& table, const std::string& solver, Holds holds) {
  const auto row = std::ranges::find_if(table.rows, [&](const auto& one) {
    return table.at(one, "solver").text() == solver && holds(one);
  });
  return row == table.rows.end() ? nullptr : &*row;
}

/// Of one solver: what its links are, and how its iterations go.
std::vector<Cell> row_of(const OneStep& step, const std::vector<Cell>& own) {
  const Answer& found = step.found;
  const Table &solvers = found.table("solvers"), &points = found.table("points"),
              &reached = found.table("reached");
  const std::string solver = solvers.at(own, "solver").text();
  const auto after = [&](int iterations) {
    const auto* row = first_of(points, solver, [&](const auto& one) {
      return points.at(one, "iterations").number() == iterations;
    });
    return row ? points.at(*row, "distance") : Cell();
  };
  const auto below = [&](double gap) {
    const auto* row = first_of(
        reached, solver, [&](const auto& one) { return reached.at(one, "below").number() == gap; });
    return row ? reached.at(*row, "iterations") : Cell::lacking(Cell::State::none, "not reached");
  };
  const double k = solvers.at(own, "structural").number();
  return {step.scene(),
          solver_label(step, solver),
          std::isnan(k) ? Cell("rigid") : Cell(shown({"N/m", "N/m"}, k, 2)),
          after(1),
          after(kLooked),
          solvers.at(own, "contraction"),
          solvers.at(own, "floor"),
          below(1e-1),
          below(1e-2),
          below(1e-4)};
}

/// The solver, if kLooked iterations leave it farther from the exact step than one, by more than
/// the tolerance; else "".
std::string leaving(const OneStep& step, const std::vector<Cell>& own) {
  const std::vector<Cell> row = row_of(step, own);
  return row[4].number() > (1 + kTolerance) * row[3].number() ? row[1].text() : "";
}

}  // namespace

Json json_of_steps(const ReportInput& input, CaseList& refs, DrawnCharts& drawn, Answer& tables) {
  Json steps;
  const std::string at = std::to_string(kLooked);
  Table table{
      "steps",
      "Iterations of one step against the exact step",
      {Column("scene"), Column("solver"), Column("links"),
       Column("after_1", "distance after 1", kLength),
       Column("after_" + at, "after " + at, kLength),
       Column("contraction", "left by each further one", kNumber, 4),
       Column("floor", "ends at", kLength), Column("to_1e-1", "iterations to a gap of 0.1"),
       Column("to_1e-2", "to 0.01"), Column("to_1e-4", "to 0.0001")},
      {},
      "From one state, which all share. Distance: RMS over the vertices; gap: of springs (G "
      "- G*)/(G0 - G*), of rigid links the squared distance over that of the prediction. "
      "Links of a solver are its own: the exact step of springs is implicit Euler's, that "
      "of rigid links the nearest placement that keeps all lengths."};
  std::vector<std::string> away;
  std::vector<Chart> charts;
  const std::list<OneStep> all(input.steps.begin(), input.steps.end());  // charts point into them
  for (const OneStep& step : all) {
    try {
      charts.push_back(step_chart(step, "distance"));
    } catch (const InputError&) {  // no exact step
    }
    for (const auto& own : step.found.table("solvers").rows)
      if (const std::string solver = leaving(step, own); !solver.empty())
        push_unique(away, solver + " on " + step.scene());
    for (const auto& own : step.found.table("solvers").rows)
      table.rows.push_back(row_of(step, own));
  }
  for (Figure& figure : figures_of(charts)) {
    figure.title = "Distance from the exact step";
    add_figure(drawn, "steps", figure, refs);
  }
  if (!away.empty())
    table.caption +=
        " Farther from the exact step after more iterations: " + joined(away) +
        ". An iteration there lowers the step's objective, whose gap the table has, not "
        "the distance.";
  add_table(steps, std::move(table), tables);
  return steps;
}

}  // namespace taut::report
