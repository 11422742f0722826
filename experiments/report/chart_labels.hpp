#pragma once

#include <utility>

#include "experiments/report/chart.hpp"
#include "experiments/report/labels.hpp"

namespace taut::report {

/// It ended without a value: a glyph above the plot.
bool failed(const Point&);

/// Where the plot lies, with room for tick labels, the names of curves and glyphs of failures. The
/// names stand at the ends of their curves; above the plot where it is narrow, where points are
/// not joined and so have no end, or where there are more names than the ends have room for.
PlotArea chart_area(const Chart&);

/// Where exact zeros lie on a logarithmic axis: just above its end.
double floor_of(const Axis& y);

/// Where shown values lie on the picture [px].
std::pair<double, double> pixel_of(const Chart&, const PlotArea&, double x, double y);

/// y = c x^slope below the lowest curve [shown units]; NaN: there is none.
double slope_factor(const Chart&);

/// What draw_chart() adds to the plot: texts, and commands for what belongs to them.
struct ChartTexts {
  Labels labels;
  std::string commands;
};
/// Names, ticks, titles, failures and notes where they have to be; theory, reference and settings
/// where there is room. Ticks whose label would run into its neighbour's lose it.
ChartTexts chart_texts(Chart&, const PlotArea&);

}  // namespace taut::report
