#include "experiments/report/chart.hpp"

namespace taut::report::figure::penetration {

namespace {

Drawing draw(const FigureSpec& spec, const FigureData& data) {
  return draw_chart(curves_chart(spec, data.records));
}

}  // namespace
}  // namespace taut::report::figure::penetration

TAUT_FIGURE(penetration) = {.name = "penetration",
                            .summary = "Depth inside the colliders over sweeps or time step",
                            .x = "iterations",
                            .y = "penetration.max",
                            .along = "iterations",
                            .draw = taut::report::figure::penetration::draw};
