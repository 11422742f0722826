#pragma once

#include <string>

#include "experiments/report/input.hpp"

namespace taut::report {

/// The report as one HTML text: page/index.html with its styles, its scripts, d3 and the model in
/// it. It needs nothing else: no request leaves it. Throws InputError if no study has a record.
std::string make_report(const ReportInput&);

}  // namespace taut::report
