#include <set>

#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::raw {

namespace {

/// Every case and every value of a study; SI units.
std::string study_csv(const StudyResult& study) {
  std::set<std::string> params, values;
  for (const Record& r : study.records) {
    for (const auto& [name, value] : r.params) params.insert(name);
    for (const auto& [name, value] : r.values) values.insert(name);
  }
  std::string out = "scene,solver,dt,steps,vertices,links,projections,status,reason,failed_step";
  for (const std::string& name : params) out += "," + csv_field(name);
  for (const std::string& name : values) out += "," + csv_field(name);
  out += ",case,digest\n";
  for (const Record& r : study.records) {
    out += csv_field(r.scene) + "," + csv_field(r.solver) + "," + exact(r.dt) + "," +
           std::to_string(r.steps) + "," + std::to_string(r.vertices) + "," +
           std::to_string(r.links) + "," + std::to_string(r.projections) + "," +
           std::string(to_string(r.status.kind)) + "," + csv_field(r.status.reason) + "," +
           (r.status.step < 0 ? "" : std::to_string(r.status.step));
    for (const std::string& name : params) {
      const auto at = r.params.find(name);
      out += "," + (at == r.params.end() ? "" : csv_field(at->second));
    }
    for (const std::string& name : values) {
      const auto at = r.values.find(name);
      out += "," + (at == r.values.end() ? "" : exact(at->second));
    }
    out += "," + csv_field(r.id) + "," + csv_field(r.digest) + "\n";
  }
  return out;
}

std::string render(Page& page, const std::string&) {
  std::string links;
  for (const StudyResult& study : page.input().studies)
    if (const std::string csv = study_csv(study); csv.size() < 400'000)
      links += "<li>" + download_link(csv, slug(study.name) + ".csv", study.name + ".csv") + " – " +
               std::to_string(study.records.size()) + " cases, every value, SI units</li>";
    else
      links += "<li>" + escape_html(study.name) + ": too large for this page; <code>taut plot " +
               escape_html(study.name) + "</code> writes it</li>";
  return "<section id=\"raw\"><h2>Raw data</h2><div class=\"card\"><ul class=\"links\">" + links +
         "</ul><p>The data of each chart are below it.</p></div></section>\n";
}

}  // namespace
}  // namespace taut::report::section::raw

TAUT_SECTION(raw) = {.name = "raw", .order = 120, .render = taut::report::section::raw::render};
