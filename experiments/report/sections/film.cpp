#include <algorithm>

#include "experiments/report/html.hpp"
#include "experiments/report/player.hpp"

namespace taut::report::section::film {

namespace {

std::string render(Page& page, const std::string& scene) {
  const auto& all = page.input().media;
  const bool filmed = std::ranges::find(all, scene, &SceneMedia::scene) != all.end();
  if (scene == page.hero() && filmed)
    return "<p class=\"wide lead\">Its film is <a href=\"#hero\">at the top</a>.</p>";
  if (scene == page.hero()) return "";
  const std::string player = scene_player(page, scene);
  return player.empty() ? ""
                        : "<div class=\"card wide player\" role=\"group\" aria-label=\"" +
                              escape_html(scene) + " side by side\">" + player + "</div>\n";
}

}  // namespace
}  // namespace taut::report::section::film

TAUT_SECTION(film) = {
    .name = "film", .order = 42, .per_scene = true, .render = taut::report::section::film::render};
