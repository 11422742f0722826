#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace taut::report {

struct ReportInput;

/// The report as one HTML text: page/index.html with its styles, its scripts, d3 and the model in
/// it. It needs nothing else: no request leaves it. Throws InputError if no study has a record.
std::string make_report(const ReportInput&);

/// The model of a report as JSON (model/MODEL.md describes every field), indented by `indent` (< 0:
/// one line). Throws InputError if no study has a record.
std::string make_model(const ReportInput&, int indent = -1);

/// A file of experiments/report/page, or d3, put into the program by CMake.
struct PageFile {
  std::string_view name;  ///< "page.js"
  std::string_view text;
};
std::span<const PageFile> page_files();

/// What the page says first, in at most nine lines: who is cheapest, and at kPricedError the
/// setting, cost and certainty on each scene; none without a bench.
std::vector<std::string> in_few_lines(const ReportInput&);

}  // namespace taut::report
