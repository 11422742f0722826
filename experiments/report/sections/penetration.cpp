#include <algorithm>
#include <cmath>

#include "experiments/report/axis.hpp"
#include "experiments/report/curves.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::penetration {

namespace {

constexpr const char* kDepth = "penetration.max";

std::string chart(Page& page, const std::string& scene, const std::string& over,
                  const std::string& held, double preferred, const std::string& heading) {
  const Slice slice = most_common(page.sweep(scene, over, kDepth), held, preferred);
  std::vector<double> depths;
  for (const Record& r : slice.records)
    if (const double depth = value_of(r, kDepth); std::isfinite(depth)) depths.push_back(depth);
  if (depths.empty()) return "";
  std::string caption = "deepest vertex inside a collider, last second; " + quantity(held).title +
                        " = " + quantity(held).text(slice.value, 3);
  if (std::ranges::all_of(depths, [](double d) { return d == 0; }))
    caption += "; every value is exactly zero";
  return page.figure({.kind = "penetration",
                      .x = over,
                      .title = heading + ", " + scene,
                      .width = 540,
                      .height = 380},
                     {slice.records, {}}, heading, caption);
}

std::string render(Page& page, const std::string& scene) {
  return chart(page, scene, "iterations", "dt", 1.0 / 64, "Penetration over sweeps") +
         chart(page, scene, "dt", "iterations", 8, "Penetration over time step");
}

}  // namespace
}  // namespace taut::report::section::penetration

TAUT_SECTION(penetration) = {.name = "penetration",
                             .order = 80,
                             .per_scene = true,
                             .render = taut::report::section::penetration::render};
