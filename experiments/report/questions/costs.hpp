#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/report/questions/case_list.hpp"
#include "experiments/timing/cheapest.hpp"

namespace taut::report {

/// The error whose price the page shows.
inline constexpr double kPricedError = 0.05;

/// The question of the price: its table's name.
inline constexpr const char* kPrice = "price";

/// The questions of costs; none without a bench.
void add_costs(Answer&, const ReportInput&, const std::vector<Column>& solvers, CaseList&);

/// "4 × 2, coloured": the parameters that take several values among the cases of one scene, except
/// those shown beside it, and the order of the links.
Label setting_label(const SceneBench&, std::size_t at, std::vector<std::string> beside = {});

/// Text after a setting whose cost is an upper bound.
inline constexpr const char* kUpperBound = "; at most";
/// Meaning of that text.
inline constexpr const char* kUpperBoundMeans =
    "at most: no cheaper setting of that solver was tried";

}  // namespace taut::report
