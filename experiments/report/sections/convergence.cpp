#include <algorithm>
#include <cmath>

#include "experiments/report/axis.hpp"
#include "experiments/report/curves.hpp"
#include "experiments/report/html.hpp"
#include "experiments/report/section.hpp"

namespace taut::report::section::convergence {

namespace {

std::string caption(const std::vector<Record>& records, double dt) {
  std::string out = "Δt = " + quantity("dt").text(dt, 3);
  const Quantity stretch = quantity("stretch.rms");
  if (std::ranges::none_of(
          records, [&](const Record& r) { return value_of(r, stretch.name) >= kNoStretch; }))
    return out + "; every value is below " + stretch.text(kNoStretch, 1) +
           ", which the verdict counts as no stretch at all";
  const std::string fitted = "; fitted exponent over the second half of the sweeps: ";
  std::string slopes;
  for (const Curve& curve : make_curves(records, "iterations", "stretch.rms", "iterations")) {
    const double from = curve.points[curve.points.size() / 2].x;
    if (const double slope = fitted_slope(curve, from); std::isfinite(slope))
      slopes += (slopes.empty() ? "" : ", ") + solver_name(curve.solver, curve.label) + " " +
                fixed(slope, 2);
  }
  return out + (slopes.empty() ? "" : fitted + slopes);
}

std::string render(Page& page, const std::string& scene) {
  const Slice slice = most_common(page.sweep(scene, "iterations", "stretch.rms"), "dt", 1.0 / 64);
  if (slice.records.empty()) return "";
  std::optional<double> slope;
  for (const StudyResult& study : page.input().studies)
    if (const auto at = study.slopes.find(scene); at != study.slopes.end()) slope = at->second;
  std::string out =
      page.figure({.kind = "error-iterations",
                   .title = "Residual stretch over sweeps, " + scene,
                   .slope = slope,
                   .width = 540,
                   .height = 380},
                  {slice.records, {}}, "Convergence: " + quantity("stretch.rms").title,
                  caption(slice.records, slice.value));
  const auto known = [](const Record& r) { return std::isfinite(value_of(r, "reference.rms")); };
  if (std::ranges::any_of(slice.records, known))
    out += page.figure({.kind = "error-iterations",
                        .y = "reference.rms",
                        .title = "Distance from the reference over sweeps, " + scene,
                        .width = 540,
                        .height = 380},
                       {slice.records, {}}, "Convergence: distance from the reference",
                       "The reference is the static equilibrium of the same cloth, which no solver "
                       "here took part in (<code>taut reference</code>)");
  return out;
}

}  // namespace
}  // namespace taut::report::section::convergence

TAUT_SECTION(convergence) = {.name = "convergence",
                             .order = 50,
                             .per_scene = true,
                             .render = taut::report::section::convergence::render};
