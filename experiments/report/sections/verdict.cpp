#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::verdicts {

namespace {

std::string title(const Page& page) {
  if (!page.input().title.empty()) return escape_html(page.input().title);
  std::string out;
  for (const Contender& c : page.facts().contenders)
    out += (out.empty() ? "" : " vs ") + solver_name(c.solver, solver_title(c.solver));
  return out;
}

std::string provenance_line(const ReportInput& input) {
  std::string out;
  std::size_t cases = 0, planned = 0;
  for (const StudyResult& study : input.studies) {
    cases += study.records.size();
    planned += study.planned > 0 ? study.planned : study.records.size();
  }
  out =
      std::to_string(cases) + (cases < planned ? " of " + std::to_string(planned) : "") + " cases";
  for (const auto& [what, value] : input.provenance)
    if (what == "version" || what == "commit") out += " · " + escape_html(value);
  return out;
}

/// The price of an error leads where it was measured; all else stands below it.
std::string sentences(const Page& page) {
  const std::string price = price_verdict(page.facts());
  const std::string rest = verdict(page.facts(), page.scenes());
  const std::string open = "<p class=\"verdict\" id=\"verdict\">";
  if (price.empty()) return open + rest + "</p>";
  return open + price + "</p><p class=\"besides\">" + rest + "</p>";
}

std::string render(Page& page, const std::string&) {
  return "<header class=\"page\"><div class=\"bar\"><span><b>taut</b> comparison report</span>"
         "<span class=\"grow\"></span><span>" +
         provenance_line(page.input()) +
         "</span><button id=\"theme\" type=\"button\" aria-label=\"light / dark: dark theme\" "
         "title=\"Switch "
         "between light and "
         "dark\">light / dark</button></div>\n<h1>" +
         title(page) + "</h1>\n" + sentences(page) + "</header>\n<main id=\"main\">\n";
}

}  // namespace
}  // namespace taut::report::section::verdicts

TAUT_SECTION(verdict) = {
    .name = "verdict", .order = 0, .render = taut::report::section::verdicts::render};
