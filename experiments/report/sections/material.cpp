#include "experiments/report/axis.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::material {

namespace {

/// Strain; less is rounding of the positions that a film keeps, far from the origin.
constexpr double kLeast = 1e-4;

std::string moment(const MaterialRow& row, const MaterialRow::Moment& one, double aspect) {
  const Quantity strain = quantity("stretch.rms");
  const std::string t = significant(one.t, 3) + " s";
  const std::string rms =
      one.rms < kLeast ? "&lt; " + strain.text(kLeast, 1) : strain.text(one.rms);
  return "<figure style=\"--aspect:" + exact(std::round(aspect * 1e3) / 1e3) + "\"><img alt=\"" +
         escape_html(solver_title(row.solver)) + ": strain in material space at " + t + ", RMS " +
         rms + "\" src=\"data:image/png;base64," + base64(one.png) + "\"><figcaption><span>" + t +
         "</span><b>" + rms + "</b></figcaption></figure>";
}

/// The sheet laid flat, without light, in the colours of the bar above: a row for each solver.
std::string render(Page& page, const std::string& scene) {
  std::string rows;
  for (const SceneMedia& media : page.input().media) {
    if (media.scene != scene) continue;
    for (const MaterialRow& row : media.material) {
      std::string stills;
      for (const MaterialRow::Moment& one : row.moments) {
        const std::size_t weight = one.png.size() * 4 / 3;
        if (weight > page.media_budget) continue;
        page.media_budget -= weight;
        stills += moment(row, one, media.aspect);
      }
      if (!stills.empty())
        rows += "<div class=\"row\"><p>" + solver_dot(row.solver) + "<b>" +
                escape_html(solver_title(row.solver)) + "</b></p>" + stills + "</div>";
    }
  }
  if (rows.empty()) return "";
  return "<div class=\"card wide material\"><h4>Strain in material space</h4><p>The sheet laid "
         "flat, unlit, in the colours of the film's bar; the number is RMS strain. The inset of "
         "the "
         "film shows the same at every moment.</p>" +
         rows + "</div>\n";
}

}  // namespace
}  // namespace taut::report::section::material

TAUT_SECTION(material) = {.name = "material",
                          .order = 45,
                          .per_scene = true,
                          .render = taut::report::section::material::render};
