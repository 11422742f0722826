#include "experiments/report/chart.hpp"

namespace taut::report::figure::work_precision {

namespace {

Drawing draw(const FigureSpec& spec, const FigureData& data) {
  Chart chart = curves_chart(spec, data.records);
  chart.stair = true;
  chart.name_points = true;
  // A line through settings that differ in two knobs would join what nobody would try in a row.
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points)
      if (p.name.find_first_of(",×") != std::string::npos) chart.lines = false;
  return draw_chart(chart);
}

}  // namespace
}  // namespace taut::report::figure::work_precision

TAUT_FIGURE(work_precision) = {
    .name = "work-precision",
    .summary = "An error over what it cost (any value on either axis), with the Pareto front",
    .x = "projections",
    .y = "stretch.rms",
    .along = "setting",
    .draw = taut::report::figure::work_precision::draw};
