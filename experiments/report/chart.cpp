#include "experiments/report/chart.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/input_error.hpp"
#include "experiments/report/chart_labels.hpp"
#include "experiments/report/format.hpp"
#include "experiments/report/palette.hpp"

namespace taut::report {

namespace {

std::string quoted(std::string_view colour) { return "'" + std::string(colour) + "'"; }

/// An empty cell would make gnuplot join the neighbours across a failure.
std::string number(double value) { return std::isfinite(value) ? exact(value) : "NaN"; }

std::string csv_row(const std::string& label, const Point& p) {
  const Record& r = *p.record;
  return csv_field(label) + "," + csv_field(r.solver) + "," + number(p.x) + "," + number(p.y) +
         "," + exact(p.along) + "," + std::string(to_string(r.status.kind)) + "," +
         csv_field(r.status.reason) + "," + csv_field(r.id) + "\n";
}

std::string make_csv(const Chart& chart) {
  std::string out = "curve,solver,x,y,along,status,reason,case\n";
  for (const Curve& curve : chart.curves) {
    if (&curve != &chart.curves.front()) out += "\n\n";
    for (const Point& p : curve.points) out += csv_row(curve.label, p);
  }
  if (!chart.stair) return out;
  out += "\n\n";
  for (const Point& p : pareto_front(chart.curves)) out += csv_row("Pareto front", p);
  return out;
}

/// The plot elements: stair, theory, then each curve with its line, markers and zeros.
std::string plot_commands(const Chart& chart) {
  const std::string sx = exact(chart.x.quantity.scale);
  const std::string sy = exact(chart.y.quantity.scale);
  const std::string floor = exact(floor_of(chart.y));
  const std::string zero = chart.y.log ? "($4 <= 0 ? " + floor + " : $4*" + sy + ")" : "$4*" + sy;
  std::string out = "measured(s) = s eq 'ok' || s eq 'unsettled'\nplot 1/0 notitle";
  if (chart.stair && !pareto_front(chart.curves).empty())
    out += ", \\\n  '@CSV@' index " + std::to_string(chart.curves.size()) + " using ($3*" + sx +
           "):" + zero + " with steps lw 7 lc rgb " + quoted(neutral("stair").light) + " notitle";
  if (const double c = slope_factor(chart); std::isfinite(c))
    out += ", \\\n  " + exact(c) + "*x**(" + exact(*chart.slope) +
           ") with lines dt (7,6) lw 1.2 lc rgb " + quoted(neutral("axis").light) + " notitle";
  for (std::size_t i = 0; i < chart.curves.size(); ++i) {
    const Curve& curve = chart.curves[i];
    if (std::ranges::none_of(curve.points, &Point::measured)) continue;
    const SolverStyle style = solver_style(curve.solver, curve.variant);
    const std::string source =
        ", \\\n  '@CSV@' index " + std::to_string(i) + " using ($3*" + sx + "):";
    const std::string colour = " lc rgb " + quoted(style.colour.light);
    const std::string dash = style.dash.empty() ? "" : " dt " + std::string(style.dash);
    const auto where = [&](const std::string& condition, const std::string& value) {
      return "(" + condition + " ? " + value + " : 1/0)";
    };
    if (chart.lines)
      out += source + where("measured(strcol(6))", zero) + " with lines lw 2.2" + dash + colour +
             " notitle";
    if (!chart.markers) continue;
    const auto points = [&](const std::string& condition, const std::string& value, int marker,
                            double size) {
      out += source + where(condition, value) + " with points pt " + std::to_string(marker) +
             " ps " + exact(size * style.marker_size) + colour + " notitle";
    };
    const std::string positive = chart.y.log ? " && $4 > 0" : "";
    points("strcol(6) eq 'ok'" + positive, zero, style.marker, 0.55);
    points("strcol(6) eq 'unsettled'" + positive, zero, style.hollow, 0.75);
    if (chart.y.log) points("measured(strcol(6)) && $4 <= 0", floor, 10, 0.9);
  }
  return out + "\n";
}

Table make_table(const Chart& chart) {
  const Quantity &x = chart.x.quantity, &y = chart.y.quantity;
  Table table{{"solver", x.title, y.title, "status"}, {}};
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points) {
      std::string status(to_string(p.record->status.kind));
      if (!p.record->status.reason.empty()) status += ": " + p.record->status.reason;
      table.rows.push_back({curve.label, x.text(p.x, 4), y.text(p.y, 3), status});
    }
  return table;
}

std::string describe(const Chart& chart) {
  std::string out = chart.y.quantity.title + " over " + chart.x.quantity.title + ". ";
  for (const Curve& curve : chart.curves) {
    const auto first = std::ranges::find_if(curve.points, &Point::measured);
    out += curve.label + ": ";
    if (first == curve.points.end()) {
      out += "no measured case. ";
      continue;
    }
    const auto last = std::find_if(curve.points.rbegin(), curve.points.rend(),
                                   [](const Point& p) { return p.measured(); });
    const auto failures = std::ranges::count_if(curve.points, failed);
    out += chart.y.quantity.text(first->y) + " at " + chart.x.quantity.text(first->x, 3) + ", " +
           chart.y.quantity.text(last->y) + " at " + chart.x.quantity.text(last->x, 3);
    out += failures > 0 ? ", " + std::to_string(failures) + " failed. " : ". ";
  }
  return out;
}

/// Keeps the lowest eighth of a logarithmic axis free of ticks, for exact zeros.
void make_room_for_zeros(Axis& y) {
  const double lowest = y.low;
  y.low /= std::pow(y.high / y.low, 1.0 / 7);
  std::erase_if(y.ticks, [&](const auto& tick) { return tick.first < lowest; });
}

/// The value that says how exact the reference of an error is; nullptr if it has none.
const char* reference_floor(const std::string& error) {
  if (error == "reference.rms" || error == "reference.max") return "reference.floor";
  if (error == "reference.motion") return "reference.motion_floor";
  return error.starts_with("stretch.") || error.starts_with("structural.") ? "reference.strain"
                                                                           : nullptr;
}

}  // namespace

Chart curves_chart(const FigureSpec& spec, std::span<const Record> records) {
  Chart chart{spec.title, spec.width, spec.height, {}, {}, {}, spec.slope};
  chart.curves = make_curves(records, spec.x, spec.y, spec.along);
  const Quantity qx = quantity(spec.x), qy = quantity(spec.y);
  std::vector<double> xs, ys;
  bool failures = false, lacking = false;  // a sound case without the value: this scene has none
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points) {
      xs.push_back(p.x * qx.scale);
      if (p.measured()) ys.push_back(p.y * qy.scale);
      failures = failures || (std::isfinite(p.x) && failed(p));
      lacking = lacking || (!p.measured() && !failed(p));
    }
  if (ys.empty() && (lacking || !failures))
    throw InputError("no case has both '" + spec.x + "' and '" + spec.y + "'");
  chart.x = spec.x == spec.along ? sweep_axis(qx, xs) : fit_axis(qx, xs, true);
  chart.y = fit_axis(qy, ys, true);
  if (std::ranges::any_of(ys, [](double y) { return y <= 0; })) make_room_for_zeros(chart.y);
  if (const char* const name = reference_floor(spec.y))
    for (const Record& record : records)
      if (const double floor = value_of(record, name); std::isfinite(floor)) chart.floor = floor;
  return chart;
}

Drawing draw_chart(Chart chart) {
  const PlotArea area = chart_area(chart);
  const ChartTexts texts = chart_texts(chart, area);
  Drawing drawing{"", make_csv(chart), describe(chart), make_table(chart), area};
  drawing.texts = texts.labels.all(), drawing.marks = texts.labels.marks();
  drawing.script = script_preamble(chart.title, area, chart.width, chart.height) +
                   script_ticks("x", chart.x) + script_ticks("y", chart.y) + texts.commands +
                   texts.labels.script() + plot_commands(chart);
  return drawing;
}

}  // namespace taut::report
