// Error over the iterations of one step, drawn in the same way as cases.
#include "experiments/report/chart/one_step.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/report/chart/format.hpp"

namespace taut::report {

std::string solver_label(const OneStep& step, const std::string& solver) {
  const std::string title = solver_title(solver_name(solver));
  const auto same = std::ranges::count_if(step.solvers, [&](const StepSolver& one) {
    return solver_title(solver_name(one.text)) == title;
  });
  const std::size_t params = solver.find(':');
  if (same < 2 || params == std::string::npos) return title;
  return title + " (" + solver.substr(params + 1) + ")";
}

Records step_records(const OneStep& step, std::string_view kind) {
  const std::string value = step_value(kind);
  Records drawn;
  for (const Record& r : step.records)
    if (r.value(value) > 0) drawn.push_back(&r);
  if (drawn.empty()) throw InputError("no solver has a " + std::string(kind) + " to draw");
  return drawn;
}

Chart step_chart(const OneStep& step, std::string_view kind) {
  Chart chart = make_chart("step", step_records(step, kind), kSweeps, step_value(kind), kSweeps);
  chart.scene = step.scene;
  chart.id = slug(step.titled_scene() + "-step-" + std::string(kind));
  chart.title = capitalised(step.subject);
  std::string floors;
  double moved = 0;
  for (const StepSolver& one : step.solvers) {
    moved = std::fmax(moved, one.moved);
    if (one.floor > 0)
      floors += (floors.empty() ? "" : ", ") + solver_label(step, one.text) + " " +
                shown(kLength, one.floor, 2);
  }
  if (!floors.empty())
    chart.caption =
        "These end on a floor, because their fixed point is another one: " + floors + ".";
  if (kind == "distance" && moved > 0)
    chart.floor = Chart::Floor{moved, "last correction of the exact step"};
  return chart;
}

}  // namespace taut::report
