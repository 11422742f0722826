#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace taut::report {

struct ReportInput;

/// The report as one HTML text: page/index.html with its styles, scripts, d3 and the model
/// embedded. It is self-contained and makes no requests. Throws InputError if no study has a
/// record.
std::string make_report(const ReportInput&);

/// The model of a report as JSON (model/MODEL.md describes every field). A negative indent puts it
/// on one line. Throws InputError if no study has a record.
std::string make_model(const ReportInput&, int indent = -1);

/// A file of experiments/report/page, or d3, which CMake embeds in the program.
struct PageFile {
  std::string_view name;  ///< "page.js"
  std::string_view text;
};
std::span<const PageFile> page_files();

/// The first statements of the page, in at most nine lines: the cheapest solvers and, at
/// kPricedError, the setting, cost and certainty on each scene. Empty without a bench.
std::vector<std::string> in_few_lines(const ReportInput&);

}  // namespace taut::report
