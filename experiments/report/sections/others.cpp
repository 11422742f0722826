#include <algorithm>

#include "experiments/report/axis.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/player.hpp"

namespace taut::report::section::others {

namespace {

std::string card(Page& page, const SceneMedia& media) {
  const std::string id = "film-" + slug(media.scene);
  return "<article class=\"card player\" id=\"" + id + "\" aria-labelledby=\"" + id +
         "-h\"><header><h3 id=\"" + id + "-h\">" + escape_html(solver_title(media.scene)) +
         "</h3><p>" + escape_html(media.summary) + "</p></header>" +
         scene_player(page, media.scene, true) + "</article>\n";
}

/// Films of the scenes that no study of this report runs.
std::string render(Page& page, const std::string&) {
  std::string links, cards;
  double longest = 0;
  for (const SceneMedia& media : page.input().media) {
    if (std::ranges::find(page.scenes(), media.scene) != page.scenes().end()) continue;
    longest = std::max(longest, media.duration);
    links += "<a href=\"#film-" + slug(media.scene) + "\">" + escape_html(media.scene) + "</a>";
    cards += card(page, media);
  }
  if (cards.empty()) return "";
  return "<section id=\"others\"><h2>The other shipped scenes</h2><p class=\"lead\">No study of "
         "this report runs them: they are shown, not judged, under the settings named, for " +
         exact(longest) + " s or less. A solver that would misread a scene refuses it.</p>" +
         "<nav class=\"jump\" aria-label=\"Other scenes\">" + links +
         "</nav><div class=\"cards films\">" + cards + "</div></section>\n";
}

}  // namespace
}  // namespace taut::report::section::others

TAUT_SECTION(others) = {
    .name = "others", .order = 75, .render = taut::report::section::others::render};
