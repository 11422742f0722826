#include "experiments/report/chart.hpp"

namespace taut::report::figure::scaling {

namespace {

Drawing draw(const FigureSpec& spec, const FigureData& data) {
  return draw_chart(curves_chart(spec, data.records));
}

}  // namespace
}  // namespace taut::report::figure::scaling

TAUT_FIGURE(scaling) = {.name = "scaling",
                        .summary = "A cost or an error over the number of vertices",
                        .x = "vertices",
                        .y = "cpu.per_step",
                        .along = "vertices",
                        .draw = taut::report::figure::scaling::draw};
