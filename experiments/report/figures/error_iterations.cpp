#include "experiments/report/chart.hpp"

namespace taut::report::figure::error_iterations {

namespace {

Drawing draw(const FigureSpec& spec, const FigureData& data) {
  return draw_chart(curves_chart(spec, data.records));
}

}  // namespace
}  // namespace taut::report::figure::error_iterations

TAUT_FIGURE(error_iterations) = {
    .name = "error-iterations",
    .summary = "An error over sweeps per step, log-log, with the theory's slope where it has one",
    .x = "iterations",
    .y = "stretch.rms",
    .along = "iterations",
    .draw = taut::report::figure::error_iterations::draw};
