// Inside one step: how close each solver's iterations come to the exact step.
#include <cmath>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/report/chart/one_step.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/model/parts.hpp"
#include "experiments/system/distinct.hpp"

namespace taut::report {

namespace {

constexpr int kLooked = kQuotedWork.sweeps;  ///< iterations, as in the comparison at equal work

/// Distance after this many iterations [m]; NaN if not measured.
double distance_after(const StepSolver& solver, int iterations) {
  const auto at = solver.distances.find(iterations);
  return at == solver.distances.end() ? std::nan("") : at->second;
}

/// Row of a solver: its links, and how its iterations proceed.
std::vector<Cell> row_of(const OneStep& step, const StepSolver& solver) {
  const auto below = [&](double gap) {
    const auto at = solver.iterations.find(gap);
    return at == solver.iterations.end() ? Cell::lacking(Cell::State::none, "not reached")
                                         : Cell(at->second);
  };
  return {step.titled_scene(),
          solver_label(step, solver.text),
          std::isnan(solver.structural)
              ? Cell("rigid")
              : Cell(shown({Unit::Kind::other, "N/m", "N/m"}, solver.structural, 2)),
          distance_after(solver, 1),
          distance_after(solver, kLooked),
          solver.contraction,
          solver.floor,
          below(1e-1),
          below(1e-2),
          below(1e-4)};
}

/// Whether the solution after kLooked iterations is farther from the exact step than after one, by
/// more than the tolerance.
bool is_leaving(const StepSolver& solver) {
  return distance_after(solver, kLooked) > (1 + kTolerance) * distance_after(solver, 1);
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
      "All solvers start from the same state. Distance: RMS over the vertices. Gap: for springs (G "
      "- G*)/(G0 - G*), for rigid links the squared distance over that of the prediction. Each "
      "solver has its own links: the exact step of springs is implicit Euler's; that of rigid "
      "links is the nearest placement that keeps all lengths."};
  std::vector<std::string> away;
  std::vector<Chart> charts;
  for (const OneStep& step : input.steps) {
    try {
      charts.push_back(step_chart(step, "distance"));
    } catch (const InputError&) {  // no exact step
    }
    for (const StepSolver& solver : step.solvers) {
      table.rows.push_back(row_of(step, solver));
      if (is_leaving(solver))
        push_unique(away, solver_label(step, solver.text) + " on " + step.titled_scene());
    }
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
