#pragma once

#include <string>
#include <string_view>

#include "experiments/report/chart/charts.hpp"
#include "experiments/steps/one_step.hpp"

namespace taut::report {

/// Title of a solver in `step`; with its parameters if several solvers share the title.
std::string solver_label(const OneStep&, const std::string& solver);

/// The records with a value above 0, which a logarithmic axis can show. Throws InputError if there
/// is no such record.
Records step_records(const OneStep&, std::string_view kind);
/// A chart that points into the records. Throws as step_records() does.
Chart step_chart(const OneStep&, std::string_view kind);

}  // namespace taut::report
