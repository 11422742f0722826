#pragma once

// Parts of the model as JSON. Included by sources of the model only: the JSON library is large.

#include <string>

#include "experiments/report/chart/charts.hpp"
#include "experiments/report/claims/claim.hpp"
#include "experiments/system/json.hpp"

namespace taut::report {

/// Appends a chart, a map, a film or a table to those of the model, and its id to a list of `part`.
void add_by_id(Json& part, const char* list, Json one, Json& all);
/// A table without rows; a column is a title, or an object of title and metric.
Json json_table(const std::string& id, const std::string& title, const std::string& caption,
                const Json& columns);
/// {low, mid, high, n}, as MODEL.md has intervals.
Json json_interval(const Interval&, std::size_t n);

/// `timed`: where its cost was measured; nullptr: nowhere.
Json json_of_case(const Record&, const BenchedCase* timed, Citations&);
/// Counts and ranges of settings of a scene's cases.
Json facts_of(const ReportInput&, const std::string& scene);
Json json_of(const Chart&, Citations&);
Json json_of(const StatusMap&, const std::string& id, Citations&);
Json json_of(const SceneMedia&, const ReportInput&, Citations&, std::size_t& budget);
/// What accuracy costs; its charts and tables go to those of the model.
Json json_of_cost(const StudyBench&, Citations&, Json& charts, Json& tables);
/// What two folders have otherwise; its table goes to those of the model.
Json json_of(const Differences&, Citations&, Json& tables);
/// What scenes require and how far solvers go; null without either. Its tables go to the model's.
Json json_of_limits(const ReportInput&, Json& tables);
/// What publications assert, with verdicts: as its truths say now, if they were checked.
Json json_of_assertions(const std::optional<Truths>&);
/// Settings of every solver on a scene, row by row; null without a case.
Json json_of_resolved_settings(const QuotedScene&, const ComparedSolvers&, Citations&);

}  // namespace taut::report
