#pragma once

// Parts of the model as JSON. Only sources of the model include this header, since the JSON library
// is large.

#include <string>

#include "experiments/report/chart/charts.hpp"
#include "experiments/report/chart/frame.hpp"
#include "experiments/report/questions/case_list.hpp"
#include "experiments/report/questions/compared_solvers.hpp"
#include "experiments/system/json.hpp"

namespace taut::report {

/// Appends a chart, a map or a film to `all`, and its id to a list of `part`.
void add_by_id(Json& part, const char* list, Json one, Json& all);
/// Charts of the model, and the figures of which they are the panels.
struct DrawnCharts {
  Json charts, figures;
};
/// Adds a figure. `of` names the part of the page that shows it.
void add_figure(DrawnCharts&, std::string_view of, const Figure&, CaseList&);
/// If a table has rows, adds it to the tables of the page and its name to the tables of `part`.
void add_table(Json& part, Table, Answer& tables);
/// The tables of an answer, by name, in the form that `taut --json` always writes.
Json json_of_tables(const Answer&);
/// {low, mid, high, n}, as MODEL.md defines intervals.
Json json_interval(const Interval&, std::size_t n);

/// `timed`: where the cost was measured; nullptr: not measured.
Json json_of_case(const Record&, const BenchedCase* timed, CaseList&);
/// Counts of a scene's cases, and ranges of their settings.
Json facts_of(const CaseList&, const std::string& scene);
Json json_of(const Chart&, CaseList&);
Json json_of(const StatusMap&, const std::string& id, CaseList&);
Json json_of(const SceneMedia&, const ReportInput&, CaseList&, std::size_t& budget);
/// Which solver wins where, a summary, and where this project's solver loses in the map and in the
/// answer; null if nothing was timed.
Json json_of_winners(const ReportInput&, const Answer&, CaseList&, Answer& tables);
/// Cost of accuracy, scene by scene.
Json json_of_cost(const ReportInput&, CaseList&, DrawnCharts&, Answer& tables);
/// Differences between two folders.
Json json_of(const Differences&, CaseList&, Answer& tables);
/// How values changed from build to build, study by study; null if there is only one build.
Json json_of_history(const ReportInput&, CaseList&);
/// What scenes require, how far solvers go, and where their methods fail; null if nothing is known.
Json json_of_limits(const ReportInput&, CaseList&, Answer& tables);
/// What iterations achieve inside one step, scene by scene; null if no step was followed.
Json json_of_steps(const ReportInput&, CaseList&, DrawnCharts&, Answer& tables);
/// Assertions of publications with verdicts, which follow from the truths if those were checked.
Table assertions_table(const std::optional<Truths>&);
/// CPU time that the cases of each solver took, and how much of it metrics did.
Table spent_table(const std::vector<const Record*>&, const std::map<std::string, Spent>&);
/// Resolved settings of every solver on a scene, one per row; without rows if nothing was run.
Table resolved_settings_table(const QuotedScene&, const ComparedSolvers&, CaseList&);
/// Sentences on what this run does not show.
std::vector<std::string> limits_of(const ReportInput&, const CaseList&);

}  // namespace taut::report
