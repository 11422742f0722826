#pragma once

#include <string>

#include "experiments/report/input.hpp"

namespace taut::report {

/// The model of a report as JSON (MODEL.md describes every field), indented by `indent` (< 0: one
/// line). Throws InputError if no study has a record.
std::string make_model(const ReportInput&, int indent = -1);

/// "Jakobsen and Bullet", or what the input says.
std::string report_title(const ReportInput&);

}  // namespace taut::report
