#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/report/chart/charts.hpp"
#include "experiments/report/input.hpp"
#include "experiments/study/campaign.hpp"

namespace taut::report {

/// The stored data of these studies, as a report needs them: records, scenes with summaries,
/// theoretical exponents, costs if they were timed, and values over time of one case per scene and
/// solver. Records are reduced to values that are numbers; only quoted cases keep their passes and
/// resolved settings. In a study with more cases than a page lists (kMostCases), records keep only
/// values with a role. Throws InputError as load_scene() does.
ReportInput stored_results(const std::vector<Study>&, const Store&);

/// Removes all values of a case except those with a role and their floors, since no table or chart
/// of a page needs others.
void keep_roles(Record&);

/// The series of a table that are shown over time.
std::vector<TimeSeries> shown_series(const Series& table, const TimeSeries& of);

/// Stored series of a value for these cases, each named by what distinguishes the case.
std::vector<TimeSeries> stored_series(const Records&, const std::string& value, const Store&);

/// Keeps only the cases of a bench that this build would run in the same way, and the scenes that
/// have any. Each scene gets its default limits.
void keep_current(StudyBench&);

/// Adds the maps among these studies (two axes and a plot of kind "stability") that have stored
/// cases. Does not read again what the input already has of a study.
void add_stored_maps(ReportInput&, const std::vector<Study>&, const Store&);

/// Pairs the cases of two results folders, whichever builds made them. Two cases match if they have
/// the same scene, settings and solver, and agree in all parameters that both builds know.
Differences stored_differences(const Store& a, const Store& b);

/// The records of `b` for these studies' cases, whichever build made them. If no study has any, all
/// records are put into one study.
ReportInput stored_anywhere(const std::vector<Study>&, const Store& b);

/// The exponent -1 where theory predicts that stretch falls as 1 / sweeps: cloth that hangs at rest
/// from pins, e ~ (dt^2/k) U f, without contact, wind and bending. nullopt elsewhere.
std::optional<double> theory_slope(const Scene&);

}  // namespace taut::report
