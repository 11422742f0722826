#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report {

namespace {

/// Stills of this scene and, below the page's top, its video: what the renderer left in `media`.
std::string render(Page& page, const std::string& scene) {
  std::string out;
  for (const SceneMedia& media : page.input().media) {
    if (media.scene != scene) continue;
    for (const Clip& still : media.stills) {
      const std::size_t weight = still.bytes.size() * 4 / 3;
      if (weight > page.media_budget) continue;
      page.media_budget -= weight;
      out += "<figure><img alt=\"" + escape_html(still.alt) + "\" src=\"data:" + still.type +
             ";base64," + base64(still.bytes) + "\"><figcaption>" + escape_html(still.alt) +
             "</figcaption></figure>";
    }
    if (scene == page.hero()) continue;
    for (const Clip& clip : media.clips) {
      const std::size_t weight = clip.bytes.size() * 4 / 3;
      if (weight > page.media_budget || clip.bytes.empty()) continue;
      page.media_budget -= weight;
      const std::string source = "data:" + clip.type + ";base64," + base64(clip.bytes);
      const std::string alt = escape_html(clip.alt);
      out += clip.type.starts_with("video/")
                 ? "<figure class=\"film\"><video controls muted playsinline preload=\"metadata\" "
                   "aria-label=\"" +
                       alt + "\" src=\"" + source + "\"></video><figcaption>" + alt +
                       "</figcaption></figure>"
                 : "<figure class=\"film\"><img alt=\"" + alt + "\" src=\"" + source +
                       "\"><figcaption>" + alt + "</figcaption></figure>";
    }
  }
  return out.empty() ? "" : "<div class=\"card wide gallery\">" + out + "</div>";
}

}  // namespace
}  // namespace taut::report

TAUT_SECTION(material) = {
    .name = "material", .order = 45, .per_scene = true, .render = taut::report::render};
