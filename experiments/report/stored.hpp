#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/report/chart/charts.hpp"
#include "experiments/report/input.hpp"
#include "experiments/study/campaign.hpp"

namespace taut::report {

/// What the store has of these studies, as the report wants it: records, scenes with their
/// summaries, the theory's exponents, costs if they were timed, values over time of one case per
/// scene and solver. Of a record is kept what a report needs: values that are numbers, and of the
/// cases that are quoted passes and resolved settings; of a study of more cases than a page lists
/// (kMostCases) only values with a role. Throws InputError as load_scene() does.
ReportInput stored_results(const std::vector<Study>&, const Store&);

/// Keeps of a case only the values with a role and their floors: no table or chart of a page needs
/// others.
void keep_roles(Record&);

/// The values that are shown over time, as far as the table has them.
std::vector<TimeSeries> shown_series(const Series& table, const TimeSeries& of);

/// A value over time of those cases of which the store has it, named by what sets them apart.
std::vector<TimeSeries> stored_series(const Records&, const std::string& value, const Store&);

/// Keeps of a bench only the cases that this build would run the same way, and the scenes that have
/// any, each with its default limits.
void keep_current(StudyBench&);

/// Adds the maps among these studies (two axes and a plot of kind "stability") of which the store
/// has something; what the input holds of a study is not read again.
void add_stored_maps(ReportInput&, const std::vector<Study>&, const Store&);

/// Pairs the cases of two results folders, whichever builds made them: the same scene, settings and
/// solver, and the same values of the parameters that both know.
Differences stored_differences(const Store& a, const Store& b);

/// The records of `b` among these studies' cases, whichever build made them; all in one study where
/// no study has any.
ReportInput stored_anywhere(const std::vector<Study>&, const Store& b);

/// -1 where theory has stretch fall as 1 / sweeps: pinned links at rest, e ~ (dt^2/k) U f, with
/// neither contact nor wind nor bending. nullopt elsewhere.
std::optional<double> theory_slope(const Scene&);

}  // namespace taut::report
