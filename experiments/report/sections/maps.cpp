#include <set>

#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::maps {

namespace {

std::string card(Page& page, const MapResult& map, const std::string& scene,
                 const std::string& solver, const std::vector<Record>& records) {
  std::set<Status::Kind> kinds;
  for (const Record& r : records) kinds.insert(r.status.kind);
  const std::string caption = status_legend(kinds, false);
  return "<div data-solver=\"" + escape_html(solver) + "\" class=\"half\">" +
         page.figure({.kind = "stability",
                      .x = map.x,
                      .y = map.y,
                      .title = "Map of " + solver + ", " + scene,
                      .file = "map-" + solver,
                      .width = 540,
                      .height = 330},
                     {records, {}}, solver_title(solver) + ", " + scene, caption) +
         "</div>";
}

/// Cards of one study: a scene at a time, our solver first, then by name.
std::string cards(Page& page, const MapResult& map) {
  std::map<std::string, std::map<std::pair<bool, std::string>, std::vector<Record>>> parts;
  for (const Record& r : map.records)
    parts[r.scene][{r.solver != "jakobsen", r.solver}].push_back(r);
  std::string out;
  for (const auto& [scene, solvers] : parts)
    for (const auto& [solver, cells] : solvers) out += card(page, map, scene, solver.second, cells);
  return out;
}

std::string render(Page& page, const std::string&) {
  std::string out =
      "<section id=\"maps\"><h2>Where solvers break</h2><p class=\"lead\">How cases end over two "
      "settings.</p>";
  if (page.input().maps.empty())
    return out + "<div class=\"card\">" + absent("No map was run; this does it:", "taut run") +
           "</div></section>\n";
  for (const MapResult& map : page.input().maps)
    out += "<h3>" + escape_html(map.question) + "</h3><div class=\"cards\">" + cards(page, map) +
           "</div>";
  return out + "</section>\n";
}

}  // namespace
}  // namespace taut::report::section::maps

TAUT_SECTION(maps) = {.name = "maps", .order = 80, .render = taut::report::section::maps::render};
