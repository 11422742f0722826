#include "experiments/report/html.hpp"
#include "experiments/report/player.hpp"

namespace taut::report::section::hero {

namespace {

std::string render(Page& page, const std::string&) {
  const std::string player = scene_player(page, page.hero());
  if (player.empty()) return "";
  return "<section id=\"hero\" class=\"card player leads\" aria-label=\"" +
         escape_html(page.hero()) + " side by side\">" + player + "</section>\n";
}

}  // namespace
}  // namespace taut::report::section::hero

TAUT_SECTION(hero) = {.name = "hero", .order = 10, .render = taut::report::section::hero::render};
