#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/report/questions/case_list.hpp"
#include "experiments/timing/cheapest.hpp"

namespace taut::report {

/// The value of kErrorMetric whose price the page shows.
inline constexpr double kPricedError = 0.01;

/// The questions of costs; none without a bench.
void add_costs(Answer&, const ReportInput&, const std::vector<Column>& solvers, CaseList&);

inline constexpr const char* kWithoutExtras =
    "without accelerators that another solver of the scene lacks";
/// The bench without cases that use a parameter which another solver of the scene lacks.
SceneBench with_shared_parameters(SceneBench);
/// "4 × 2, coloured": the parameters that take several values among the cases of one scene, except
/// those shown beside it, and the order of the links.
Label setting_label(const SceneBench&, std::size_t at, std::vector<std::string> beside = {});

/// A cell with these words if settings of the solver reach the error but do not count. It has the
/// state and the reason of the cheapest of them, such as "hardly moves: 5 % of the way".
std::optional<Cell> only_uncounted(const JudgedScene&, const std::string& solver, double error,
                                   const std::string& words);

/// Text after a setting whose cost is an upper bound.
inline constexpr const char* kUpperBound = "; at most";
/// Meaning of that text.
inline constexpr const char* kUpperBoundMeans =
    "at most: no cheaper setting of that solver was tried";

}  // namespace taut::report
