#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/report/questions/case_list.hpp"
#include "experiments/timing/cheapest.hpp"

namespace taut::report {

/// The value of kErrorMetric whose price the page says.
inline constexpr double kPricedError = 0.01;

/// The questions of costs; none without a bench.
void add_costs(Answer&, const ReportInput&, const std::vector<Column>& solvers, CaseList&);

inline constexpr const char* kWithoutExtras =
    "without accelerators that another solver of the scene lacks";
/// Without the cases that use a parameter which another solver of the scene lacks.
SceneBench with_shared_parameters(SceneBench);
/// "4 × 2, coloured": of cases of one scene those parameters that take several values, without
/// those that are shown beside it, and the order of the links.
Label setting_label(const SceneBench&, std::size_t at, std::vector<std::string> beside = {});

/// If the settings of a solver that reach the error do not count: a cell of these words, with the
/// state and the reason of the cheapest, such as "hardly moves: 5 % of the way".
std::optional<Cell> only_uncounted(const JudgedScene&, const std::string& solver, double error,
                                   const std::string& words);

/// Behind the setting of an upper bound.
inline constexpr const char* kUpperBound = "; at most";
/// What it means.
inline constexpr const char* kUpperBoundMeans =
    "at most: no cheaper setting of that solver was tried";

}  // namespace taut::report
