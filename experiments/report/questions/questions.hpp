#pragma once

#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/report/questions/case_list.hpp"
#include "experiments/report/questions/compared_solvers.hpp"

namespace taut::report {

/// What a run says of its solvers, a table for each question. Its rows are scenes, its columns
/// solvers; the last row sums up the scenes on which every solver that has a value anywhere has
/// one. A cell is a value or the reason why there is none: "not run", "cannot: friction",
/// "exploded". Its note is the setting where that is not the same for all. The best of a row is
/// marked in questions of cost, of what one cost buys, and of failures: if it is better by more
/// than kTolerance and, of costs, by more than identical code differed from itself (judge()).
Answer answer_of(const ReportInput&, const ComparedSolvers&, CaseList&);

// The questions with a file of their own; each adds its table if a scene has a row. `solvers` are
// the columns: those compared first, in their order.

void add_largest_steps(Answer&, const ComparedSolvers&, const std::vector<Column>& solvers,
                       CaseList&);
void add_failures(Answer&, const ComparedSolvers&, const std::vector<Column>& solvers, CaseList&);

}  // namespace taut::report
