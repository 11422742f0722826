#include <algorithm>
#include <cmath>

#include "experiments/report/axis.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::limits {

namespace {

bool timed(const ReportInput& input) {
  return input.bench || std::ranges::any_of(input.studies, [](const StudyResult& study) {
           return std::ranges::any_of(study.records, [](const Record& r) {
             return std::isfinite(value_of(r, kCpuValue));
           });
         });
}

std::string render(Page& page, const std::string&) {
  const ReportInput& input = page.input();
  std::string points;
  const auto point = [&](const std::string& text) { points += "<li>" + text + "</li>"; };
  if (input.bench)
    point("Cost elsewhere. Times were measured on one machine (" +
          escape_html(input.bench->machine) +
          "), with the settings that were tried; a finer search may find cheaper ones: <code>taut "
          "advise</code>.");
  else if (!timed(input))
    point(
        "Cost in time. Equal sweeps are equal work, not equal time; <code>taut bench</code> "
        "measures CPU time.");
  point(
      "Real cloth. Every error here is a distance from the constraints or from a closed form, not "
      "from a measured fabric.");
  point(
      "What the engines are good at elsewhere: Bullet's collision shapes, rigid-body coupling and "
      "material parameters are outside these scenes.");
  point(
      "Visual quality. Less stretch is not always better looking; damping and relaxation change "
      "motion as well as error.");
  point(
      "Other machines. Results repeat bit for bit on one build; a Bullet built otherwise or "
      "another kind of processor may "
      "change the last digits.");
  std::size_t records = 0, planned = 0;
  for (const StudyResult& study : input.studies)
    records += study.records.size(), planned += std::max(study.planned, study.records.size());
  if (records < planned)
    point("The " + std::to_string(planned - records) + " planned cases that have not been run.");
  return "<section id=\"limits\"><h2>What this comparison does not show</h2><div "
         "class=\"card\"><ul>" +
         points +
         "</ul></div></section>\n<footer>One file, no network requests: it works offline "
         "and prints to A4.</footer>\n";
}

}  // namespace
}  // namespace taut::report::section::limits

TAUT_SECTION(limits) = {
    .name = "limits", .order = 130, .render = taut::report::section::limits::render};
