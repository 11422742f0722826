// What scenes require of a model, and how far solvers go.
#include <algorithm>
#include <cmath>

#include "experiments/report/chart/wording.hpp"
#include "experiments/report/model/parts.hpp"
#include "experiments/report/questions/failure_map.hpp"
#include "experiments/system/distinct.hpp"

namespace taut::report {

namespace {

std::string limit_text(double value, const ParameterFrontier& one) {
  return significant(value, 3) + (one.unit.empty() ? "" : "\u00A0" + one.unit);
}

std::string end_text(const ParameterFrontier& one) {
  if (!one.lacks.empty()) return "–: " + one.lacks;
  if (std::isnan(one.bad)) return limit_text(one.to, one) + ", the end of the range";
  return (std::isnan(one.good) ? "none" : limit_text(one.good, one)) + ", then " + one.symptom +
         (std::isnan(one.theory) ? "" : " (theory: " + limit_text(one.theory, one) + ")");
}

Table frontier_table(const std::vector<ParameterFrontier>& frontiers) {
  std::vector<std::string> solvers, parameters;
  for (const ParameterFrontier& f : frontiers) {
    push_unique(solvers, f.solver);
    push_unique(parameters, f.parameter);
  }
  Table table{"frontiers",
              "How far every parameter goes on a small swinging sheet",
              {Column("parameter")},
              {},
              "The hardest setting up to which nothing was wrong, and what goes wrong first beyond "
              "it, by its own metric; taut frontier --all."};
  for (const std::string& solver : solvers) table.columns.emplace_back(solver, solver);
  for (const std::string& parameter : parameters) {
    std::vector<Cell> row{parameter};
    for (const std::string& solver : solvers) {
      const auto at = std::ranges::find_if(
          frontiers, [&](const auto& f) { return f.parameter == parameter && f.solver == solver; });
      row.push_back(at == frontiers.end() ? Cell() : Cell(end_text(*at)));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Json json_of_limits(const ReportInput& input, CaseList& refs, Answer& tables) {
  Json limits;
  const std::vector<Record> timed = input.bench ? input.bench->records() : std::vector<Record>();
  for (const StudyResult& study : input.studies)
    if (Table map = failure_map(study.records, timed, &refs); !map.rows.empty()) {
      add_table(limits, std::move(map), tables);
      break;  // only the first study that has one
    }
  Table table{"required",
              "The smallest model that keeps a scene's answers",
              {},
              {},
              "taut require takes away or coarsens one effect at a time and then all that can go; "
              "an answer may move by its tolerance, or by what a rounding error at the start moves "
              "it. Of a chaotic scene only statistics are kept."};
  for (const char* name :
       {"scene", "solver", "chaotic", "kept answers", "can go", "required", "CPU time left"})
    table.columns.emplace_back(name);
  for (const Json& row : input.required) {
    auto& cells = table.rows.emplace_back();
    for (const Json& cell : row) cells.emplace_back(cell.get<std::string>());
  }
  add_table(limits, std::move(table), tables);
  add_table(limits, frontier_table(input.frontiers), tables);
  return limits;
}

}  // namespace taut::report
