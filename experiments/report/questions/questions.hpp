#pragma once

#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/report/questions/case_list.hpp"
#include "experiments/report/questions/compared_solvers.hpp"

namespace taut::report {

/// The results of a run, with a table for each question. Its rows are scenes and its columns
/// solvers. The last row combines the scenes on which every solver with any value in the table has
/// one. A cell is a value, or the reason why there is no value: "not run", "cannot: friction",
/// "exploded". Its note is the setting, if not all share it. The best of a row is marked in
/// questions of cost, of what a cost buys, and of failures. It has to be better by more than
/// kTolerance and, for costs, by more than identical code differed from itself (judge()).
Answer answer_of(const ReportInput&, const ComparedSolvers&, CaseList&);

// Questions with a file of their own. Each adds its table if a scene has a row. `solvers` are the
// columns: the compared solvers first, in their order.

inline constexpr const char* kLargestStep = "largest_step";  ///< its table's name
void add_largest_steps(Answer&, const ComparedSolvers&, const std::vector<Column>& solvers,
                       CaseList&);
void add_failures(Answer&, const ComparedSolvers&, const std::vector<Column>& solvers, CaseList&);

}  // namespace taut::report
