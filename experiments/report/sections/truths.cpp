#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report {

namespace {

std::string body(const ReportInput& input) {
  if (!input.truths)
    return absent("Closed forms and published numbers are evaluated apart:", "taut verify");
  Table table{{"truth", "solver", "statement", "expected", "measured", "holds"}, {}};
  for (const TruthRow& row : *input.truths)
    table.rows.push_back({row.name, row.solver, row.statement, row.expected, row.measured,
                          row.holds ? "yes" : "NO"});
  return html_table(table, "Closed forms beside measured values");
}

std::string render(Page& page, const std::string&) {
  return "<section id=\"truths\"><h2>Truths</h2><p class=\"lead\">Where theory gives a number, the "
         "solvers are held to it.</p><div class=\"card\">" +
         body(page.input()) + "</div></section>\n";
}

}  // namespace
}  // namespace taut::report

TAUT_SECTION(truths) = {.name = "truths", .order = 90, .render = taut::report::render};
