#pragma once

#include <string>
#include <string_view>

#include "experiments/report/chart/charts.hpp"
#include "experiments/steps/one_step.hpp"

namespace taut::report {

/// Title of one of its solvers, with its parameters where several have that title.
std::string solver_label(const OneStep&, const std::string& solver);

/// The records with a value above 0, which a logarithmic axis shows. Throws InputError if there is
/// none.
Records step_records(const OneStep&, std::string_view kind);
/// Points into the records. Throws as step_records().
Chart step_chart(const OneStep&, std::string_view kind);

}  // namespace taut::report
