#include <set>

#include "experiments/report/axis.hpp"
#include "experiments/report/curves.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::stability {

namespace {

std::string legend(const std::vector<Record>& records) {
  std::set<Status::Kind> kinds;
  for (const Record& r : records) kinds.insert(r.status.kind);
  return status_legend(kinds, false);
}

std::string render(Page& page, const std::string& scene) {
  const auto records = page.sweep(scene, "dt", "");
  std::set<double> sweeps, steps;
  for (const Record& r : records) sweeps.insert(value_of(r, "iterations")), steps.insert(r.dt);
  if (steps.size() < 3 || sweeps.size() < 3) return "";  // no map, only a few cells
  std::string out;
  for (const Curve& curve : make_curves(records, "dt", "iterations", "dt")) {
    const std::string& solver = curve.solver;
    if (out.find("data-solver=\"" + solver + "\"") != std::string::npos) continue;
    std::vector<Record> own;
    for (const Record& r : records)
      if (r.solver == solver) own.push_back(r);
    out += "<div data-solver=\"" + solver + "\" class=\"half\">" +
           page.figure({.kind = "stability",
                        .title = "Stability of " + solver + ", " + scene,
                        .width = 540,
                        .height = 330},
                       {own, {}}, "Stability: " + solver_title(solver), legend(own)) +
           "</div>";
  }
  return out.empty() ? "" : "<div class=\"wide cards\">" + out + "</div>";
}

}  // namespace
}  // namespace taut::report::section::stability

TAUT_SECTION(stability) = {.name = "stability",
                           .order = 70,
                           .per_scene = true,
                           .render = taut::report::section::stability::render};
