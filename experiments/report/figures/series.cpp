#include <algorithm>
#include <cmath>

#include "core/model/input_error.hpp"
#include "experiments/report/chart.hpp"

namespace taut::report::figure::series {

namespace {

/// The axis of a strain reaches at least so far: rounding does not fill a picture.
constexpr double kLeastStrain = 1e-3;

/// People read a few dozen moments; the CSV has them all.
void thin(Table& table) {
  const std::size_t stride = table.rows.size() / 60 + 1;
  for (std::size_t i = 0; i * stride < table.rows.size(); ++i)
    if (stride > 1 && i > 0) table.rows[i] = std::move(table.rows[i * stride]);
  table.rows.resize((table.rows.size() + stride - 1) / stride);
  table.header.pop_back();
  for (auto& row : table.rows) row.pop_back();
}

/// Every curve shares one record that stands for "measured": moments have no status of their own.
Drawing draw(const FigureSpec& spec, const FigureData& data) {
  static const Record moment;
  Chart chart{.title = spec.title, .width = spec.width, .height = spec.height, .markers = false};
  std::vector<double> ts, ys;
  const Quantity y = quantity(spec.y);
  for (const TimeSeries& series : data.series) {
    if (series.value != spec.y) continue;
    const auto same = std::ranges::count(chart.curves, series.solver, &Curve::solver);
    Curve curve{series.label, series.solver, static_cast<int>(same), {}};
    for (std::size_t i = 0; i < std::min(series.t.size(), series.y.size()); ++i) {
      curve.points.push_back({series.t[i], series.y[i], series.t[i], &moment});
      ts.push_back(series.t[i]);
      ys.push_back(series.y[i] * y.scale);
    }
    chart.curves.push_back(std::move(curve));
  }
  if (ts.empty()) throw InputError("no series of '" + spec.y + "' was recorded");
  chart.x = fit_axis(quantity("t"), ts, false);
  chart.x.high = *std::ranges::max_element(ts);
  std::erase_if(chart.x.ticks, [&](const auto& tick) { return tick.first > chart.x.high; });
  if (y.unit == "%") ys.push_back(kLeastStrain * y.scale);
  chart.y = fit_axis(y, ys, false);
  Drawing drawing = draw_chart(chart);
  thin(drawing.table);
  return drawing;
}

}  // namespace
}  // namespace taut::report::figure::series

TAUT_FIGURE(series) = {.name = "series",
                       .summary = "A value over simulated time",
                       .x = "t",
                       .y = "stretch.rms",
                       .along = "t",
                       .draw = taut::report::figure::series::draw};
