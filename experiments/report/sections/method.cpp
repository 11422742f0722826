#include <algorithm>
#include <map>
#include <set>

#include "experiments/report/axis.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::method {

namespace {

/// "15.62 ms", "100 ms": four digits, but no zeros behind the point.
std::string plain(const Quantity& q, double value) {
  std::string text = q.text(value, 4);
  const std::size_t end = std::min(text.find("\u00A0"), text.size());
  if (text.find('.') >= end) return text;
  std::size_t last = text.find_last_not_of('0', end - 1);
  if (text[last] == '.') --last;
  return text.erase(last + 1, end - last - 1);
}

/// "1, 2, 4" or "1 to 256 (9 values)".
std::string range_of(const std::set<double>& values, const Quantity& q) {
  if (values.empty()) return "–";
  if (values.size() > 3)
    return plain(q, *values.begin()) + " to " + plain(q, *values.rbegin()) + " (" +
           std::to_string(values.size()) + " values)";
  std::string out;
  for (const double v : values) out += (out.empty() ? "" : ", ") + plain(q, v);
  return out;
}

Table scene_table(const Page& page) {
  Table table{{"scene", "vertices", "links", "time step", "simulated", "sweeps", "cases"}, {}};
  for (const std::string& scene : page.scenes()) {
    std::set<double> vertices, links, dts, spans, sweeps;
    std::size_t cases = 0;
    for (const StudyResult& study : page.input().studies)
      for (const Record& r : study.records) {
        if (r.scene != scene) continue;
        ++cases;
        vertices.insert(r.vertices), links.insert(r.links), dts.insert(r.dt);
        // Rounded: steps x dt differs by less than a step between time steps.
        spans.insert(std::stod(significant(r.steps * r.dt, 2)));
        if (const double k = value_of(r, "iterations"); k > 0) sweeps.insert(k);
      }
    table.rows.push_back({scene, range_of(vertices, quantity("vertices")),
                          range_of(links, quantity("links")), range_of(dts, quantity("dt")),
                          range_of(spans, quantity("t")), range_of(sweeps, quantity("iterations")),
                          std::to_string(cases)});
  }
  return table;
}

Table solver_table(const Page& page) {
  Table table{{"solver", "what it is", "source", "compared with"}, {}};
  for (const Contender& c : page.facts().contenders) {
    std::string summary = "–", source = "–", params;
    for (const SolverInfo& info : page.input().solvers)
      if (info.name == c.solver) summary = info.summary, source = info.source;
    for (const auto& [key, value] : c.records.front().params)
      if (key != "iterations") params += (params.empty() ? "" : ", ") + key + "=" + value;
    table.rows.push_back({solver_title(c.solver), summary, source, params});
  }
  return table;
}

std::string studies(const ReportInput& input) {
  std::string out = "<dl class=\"facts\">";
  for (const StudyResult& study : input.studies)
    out += "<dt>study <code>" + escape_html(study.name) + "</code></dt><dd>" +
           escape_html(study.question) + " (" + std::to_string(study.records.size()) +
           (study.planned > study.records.size() ? " of " + std::to_string(study.planned) : "") +
           " cases)</dd>";
  for (const auto& [what, value] : input.provenance)
    out += "<dt>" + escape_html(what) + "</dt><dd>" + escape_html(value) + "</dd>";
  return out + "</dl>";
}

std::string render(Page& page, const std::string&) {
  const std::string& command = page.input().command;
  return "<section id=\"method\"><h2>Method</h2><div class=\"card\">" +
         html_table(solver_table(page), "Solvers") + html_table(scene_table(page), "Scenes") +
         studies(page.input()) +
         (command.empty() ? ""
                          : "<p>This command makes it all again:</p><pre class=\"command\" "
                            "tabindex=\"0\"><code>" +
                                escape_html(command) + "</code></pre>") +
         "</div></section>\n";
}

}  // namespace
}  // namespace taut::report::section::method

TAUT_SECTION(method) = {
    .name = "method", .order = 110, .render = taut::report::section::method::render};
