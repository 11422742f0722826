#pragma once

#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/questions/case_list.hpp"

namespace taut::report {

/// Its name, which `taut run STUDY --table` knows too.
inline constexpr const char* kFailureMap = "failure_map";

/// Who is right, who freezes, strains or explodes, of cases whose links differ in stiffness: a row
/// for each solver with its settings, a column for each scene and stiffness. A cell is a verdict,
///
///     its status   where the case did not complete: exploded, extreme, cannot
///     strains      RMS stretch above 0.5 %
///     freezes      it goes less than half of its way, way_gone (experiments/timing/way.hpp)
///     late         less than nine tenths
///     gains energy energy.peak is above 2 % of m g L: of cloth that hardly strains, motion
///     right        none of these
///
/// the first that holds, with the numbers behind it in its note. Without rows where no two cases of
/// a scene differ in stiffness alone. Of the records that are among `timed`, what a simulated
/// second costs (StudyBench::records). `list`: where its cells lead; null: nowhere.
Table failure_map(const Records&, const std::vector<Record>& timed, CaseList* list);

}  // namespace taut::report
