#include <algorithm>
#include <cmath>

#include "experiments/report/axis.hpp"
#include "experiments/report/curves.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::work_precision {

namespace {

/// Where this scene's CPU time is to be found, or how to get it.
std::string about_time(const Page& page, const std::string& scene) {
  const auto& bench = page.input().bench;
  const bool there =
      bench && std::ranges::find(bench->scenes, scene, &SceneBench::scene) != bench->scenes.end();
  return "; work counted in projections, " +
         std::string(there ? "CPU time is under <a href=\"#trade\">what accuracy costs</a>"
                           : "<code>taut bench</code> measures CPU time");
}

std::string render(Page& page, const std::string& scene) {
  const auto all = page.sweep(scene, "iterations", "stretch.rms");
  const bool timed = std::ranges::any_of(
      all, [](const Record& r) { return std::isfinite(value_of(r, kCpuValue)); });
  const Slice slice = most_common(all, "dt", 1.0 / 64);
  if (slice.records.empty()) return "";
  return page.figure(
      {.kind = "work-precision",
       .x = timed ? kCpuValue : "projections",
       .title = "Stretch over work, " + scene,
       .width = 540,
       .height = 380},
      {slice.records, {}}, "Work–precision",
      std::string("down and left is better; numbers are sweeps, the grey stair is the Pareto "
                  "front") +
          (timed ? "" : about_time(page, scene)));
}

}  // namespace
}  // namespace taut::report::section::work_precision

TAUT_SECTION(work_precision) = {.name = "work-precision",
                                .order = 60,
                                .per_scene = true,
                                .render = taut::report::section::work_precision::render};
