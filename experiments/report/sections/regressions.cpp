#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::regressions {

namespace {

std::string body(const ReportInput& input) {
  if (!input.regressions)
    return absent("Not compared with the committed baselines by this build; this does it:",
                  "taut check --record");
  const Regressions& found = *input.regressions;
  const std::string compared = std::to_string(found.values) + " values of " +
                               std::to_string(found.cases) +
                               " cases were compared with the committed baselines";
  if (found.rows.empty()) return "<p>" + compared + ": none left its tolerance.</p>";
  Table table{{"case", "study", "change"}, {}};
  for (const auto& [study, id, change] : found.rows) table.rows.push_back({id, study, change});
  return "<p>" + compared + "; " + std::to_string(found.rows.size()) + " differ:</p>" +
         html_table(table, "Differences from the baselines");
}

std::string render(Page& page, const std::string&) {
  return "<section id=\"regressions\"><h2>Regressions</h2><div class=\"card\">" +
         body(page.input()) + "</div></section>\n";
}

}  // namespace
}  // namespace taut::report::section::regressions

TAUT_SECTION(regressions) = {
    .name = "regressions", .order = 100, .render = taut::report::section::regressions::render};
