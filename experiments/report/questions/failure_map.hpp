#pragma once

#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/questions/case_list.hpp"

namespace taut::report {

/// Name of the table, which `taut run STUDY --table` accepts too.
inline constexpr const char* kFailureMap = "failure_map";

/// Verdicts on cases whose links differ in stiffness: who is right, freezes, strains or explodes.
/// Each solver with its parameters has a row, each task and stiffness a column, however they are
/// written; a second result for the same cell gets a row of its own. A cell is the first verdict
/// of this list that applies:
///
///     its status    where the case did not complete: exploded, extreme, cannot
///     strains       RMS stretch above kStrained (failure_map.cpp)
///     freezes       it goes less than kLeastMotion (experiments/metrics/metric.hpp) of its way
///     late          it goes less than kLate of its way
///     gains energy  energy.peak is above kGained, in m g L: energy of motion, since the cloth
///                   hardly strains
///     right         none of these
///
/// Its note has the numbers behind it. The table has no rows if no two cases of a scene differ only
/// in stiffness. Records that are among `timed` also show the cost of a simulated second
/// (StudyBench::records). `list` receives the cases to which cells lead; it may be null.
Table failure_map(const Records&, const std::vector<Record>& timed, CaseList* list);

}  // namespace taut::report
