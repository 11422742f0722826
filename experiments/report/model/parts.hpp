#pragma once

// Parts of the model as JSON. Included by sources of the model only: the JSON library is large.

#include <string>

#include "experiments/report/chart/charts.hpp"
#include "experiments/report/chart/frame.hpp"
#include "experiments/report/questions/case_list.hpp"
#include "experiments/report/questions/compared_solvers.hpp"
#include "experiments/system/json.hpp"

namespace taut::report {

/// Appends a chart, a map or a film to those of the model, and its id to a list of `part`.
void add_by_id(Json& part, const char* list, Json one, Json& all);
/// Charts of the model, and the figures whose panels they are.
struct DrawnCharts {
  Json charts, figures;
};
/// `of`: which part of the page has it.
void add_figure(DrawnCharts&, std::string_view of, const Figure&, CaseList&);
/// Adds a table to those of the page, if it has rows, and its name to the tables of `part`.
void add_table(Json& part, Table, Answer& tables);
/// The tables of an answer by name, as `taut --json` writes them everywhere.
Json json_of_tables(const Answer&);
/// To more significant digits than a page can show: a third of the bytes of what it lists.
double rounded(double, int digits = 7);
/// {low, mid, high, n}, as MODEL.md has intervals.
Json json_interval(const Interval&, std::size_t n);

/// `timed`: where its cost was measured; nullptr: nowhere.
Json json_of_case(const Record&, const BenchedCase* timed, CaseList&);
/// Counts and ranges of settings of a scene's cases.
Json facts_of(const CaseList&, const std::string& scene);
Json json_of(const Chart&, CaseList&);
Json json_of(const StatusMap&, const std::string& id, CaseList&);
Json json_of(const SceneMedia&, const ReportInput&, CaseList&, std::size_t& budget);
/// Who wins where, and what that says in all; null: nothing was timed.
Json json_of_winners(const ReportInput&, CaseList&);
/// What accuracy costs, scene by scene.
Json json_of_cost(const ReportInput&, CaseList&, DrawnCharts&, Answer& tables);
/// What two folders have otherwise.
Json json_of(const Differences&, CaseList&, Answer& tables);
/// How values went from build to build, study by study; null: of one build alone.
Json json_of_history(const ReportInput&, CaseList&);
/// What scenes require, how far solvers go and where their methods fail; null without any.
Json json_of_limits(const ReportInput&, CaseList&, Answer& tables);
/// What iterations inside one step bring, scene by scene; null: no step was followed.
Json json_of_steps(const ReportInput&, CaseList&, DrawnCharts&, Answer& tables);
/// What publications assert, with verdicts: as its truths say now, if they were checked.
Table assertions_table(const std::optional<Truths>&);
/// Settings of every solver on a scene, row by row; without rows if nothing was run.
Table resolved_settings_table(const QuotedScene&, const ComparedSolvers&, CaseList&);
/// What this run does not show, a sentence each.
std::vector<std::string> limits_of(const ReportInput&, const CaseList&);

}  // namespace taut::report
