#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report {

namespace {

std::string body(const ReportInput& input) {
  if (!input.regressions)
    return absent("Not compared with the committed baselines; this does it:", "taut check");
  if (input.regressions->empty())
    return "<p>No case left the tolerances of the committed baselines.</p>";
  Table table{{"case", "value", "baseline", "now", ""}, {}};
  for (const RegressionRow& row : *input.regressions)
    table.rows.push_back(
        {row.id, row.value, row.baseline, row.now, row.worse ? "worse" : "better"});
  return html_table(table, "Cases outside the tolerances of the baselines");
}

std::string render(Page& page, const std::string&) {
  return "<section id=\"regressions\"><h2>Regressions</h2><div class=\"card\">" +
         body(page.input()) + "</div></section>\n";
}

}  // namespace
}  // namespace taut::report

TAUT_SECTION(regressions) = {.name = "regressions", .order = 100, .render = taut::report::render};
