#include "experiments/report/chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/model/input_error.hpp"
#include "experiments/report/format.hpp"
#include "experiments/report/palette.hpp"

namespace taut::report {

namespace {

constexpr double kLabelGap = 16;   ///< px between the labels at the ends of curves
constexpr double kStripRow = 15;   ///< px for each curve with failures
constexpr double kKeyRow = 17;     ///< px for names above the plot
constexpr double kKeyMarker = 16;  ///< px before a name

std::string quoted(std::string_view colour) { return "'" + std::string(colour) + "'"; }
std::string paint(std::string_view name) { return quoted(neutral(name).light); }

bool failed(const Point& p) {
  const auto kind = p.record->status.kind;
  return kind != Status::Kind::ok && kind != Status::Kind::unsettled;
}

std::size_t failing_curves(const Chart& chart) {
  return static_cast<std::size_t>(std::ranges::count_if(
      chart.curves, [](const Curve& c) { return std::ranges::any_of(c.points, failed); }));
}

bool is_narrow(const Chart& chart) { return chart.width < kNarrow; }

/// Where the names above a narrow plot begin, as column [px] and row: as many a row as fit.
std::vector<std::pair<double, int>> key_places(const Chart& chart) {
  std::vector<std::pair<double, int>> places;
  double x = 0;
  int row = 0;
  for (const Curve& curve : chart.curves) {
    const double width = kKeyMarker + text_width(curve.label);
    if (x > 0 && x + width > chart.width - 8) x = 0, ++row;
    places.emplace_back(x, row);
    x += width + 12;
  }
  return places;
}

PlotArea layout(const Chart& chart) {
  double widest = 0;
  for (const Curve& curve : chart.curves) widest = std::max(widest, text_width(curve.label));
  const bool narrow = is_narrow(chart);
  const double right = narrow ? 14 : std::min(widest + 22, chart.width * 0.42);
  const double strip = static_cast<double>(failing_curves(chart)) * kStripRow;
  const double key = narrow ? kKeyRow * (key_places(chart).back().second + 1) : 0;
  double ticks = 0;
  for (const auto& tick : chart.y.ticks) ticks = std::max(ticks, text_width(tick.second));
  return {std::max(narrow ? 52.0 : 68.0, ticks + (narrow ? 37 : 40)),
          chart.width - right,
          (chart.title.empty() ? 14 : 48) + strip + key,
          chart.height - 54.0,
          chart.x.low,
          chart.x.high};
}

/// Where exact zeros lie on a logarithmic axis: just above its end.
double floor_of(const Axis& y) { return y.log ? y.low * std::pow(y.high / y.low, 0.035) : y.low; }

/// Positions in the script: the last measured point of a curve, in px from the top.
double end_height(const Chart& chart, const PlotArea& area, const Curve& curve) {
  double y = 0.5;
  for (const Point& p : curve.points)
    if (p.measured())
      y = chart.y.position(std::max(p.y * chart.y.quantity.scale, floor_of(chart.y)));
  return area.bottom - y * (area.bottom - area.top);
}

std::string screen(double x, double y, const Chart& chart) {
  return "screen " + exact(std::round(x * 1e5 / chart.width) / 1e5) + "," +
         exact(std::round((chart.height - y) * 1e5 / chart.height) / 1e5);
}

/// Placed by hand: gnuplot would put the title of y where long tick labels push it out of the
/// picture.
std::string axis_titles(const Chart& chart, const PlotArea& area) {
  const std::string style = " tc rgb " + paint("muted") + " font ',12'\n";
  return "set label " + gnuplot_string(chart.x.quantity.label()) + " at " +
         screen((area.left + area.right) / 2, area.bottom + 40, chart) + " center" + style +
         "set label " + gnuplot_string(chart.y.quantity.label()) + " at " +
         screen(14, (area.top + area.bottom) / 2, chart) + " center rotate by 90" + style;
}

/// The names above a narrow plot, each with the marker of its curve.
std::string key(const Chart& chart) {
  std::string out;
  const auto places = key_places(chart);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Curve& curve = chart.curves[i];
    const SolverStyle style = solver_style(curve.solver, curve.variant);
    const std::string colour = " rgb " + quoted(style.colour.light);
    const double y = (chart.title.empty() ? 10 : 44) + kKeyRow * places[i].second;
    if (chart.markers)
      out += "set label '' at " + screen(places[i].first + 6, y, chart) + " point pt " +
             std::to_string(style.marker) + " ps " + exact(0.55 * style.marker_size) + " lc" +
             colour + "\n";
    out += "set label " + gnuplot_string(curve.label) + " at " +
           screen(places[i].first + kKeyMarker, y, chart) + " left tc" + colour + " font ',12'\n";
  }
  return out;
}

std::string end_labels(const Chart& chart, const PlotArea& area) {
  if (is_narrow(chart)) return key(chart);
  std::vector<double> at;
  for (const Curve& curve : chart.curves) at.push_back(end_height(chart, area, curve));
  at = spread_labels(at, kLabelGap, area.top + 4, area.bottom - 4);
  std::string out;
  for (std::size_t i = 0; i < at.size(); ++i)
    out += "set label " + gnuplot_string(chart.curves[i].label) + " at " +
           screen(area.right + 10, at[i], chart) + " left tc rgb " +
           quoted(solver_style(chart.curves[i].solver).colour.light) + " font ',12'\n";
  return out;
}

/// One row of glyphs above the plot for each curve with failures, in its colour.
std::string failure_strip(const Chart& chart, const PlotArea& area) {
  std::string out;
  double y = area.top - static_cast<double>(failing_curves(chart)) * kStripRow + kStripRow / 2 - 3;
  for (const Curve& curve : chart.curves) {
    if (std::ranges::none_of(curve.points, failed)) continue;
    const std::string colour = quoted(solver_style(curve.solver).colour.light);
    const bool refused = std::ranges::all_of(curve.points, [](const Point& p) {
      return !failed(p) || p.record->status.kind == Status::Kind::unsupported;
    });
    out += std::string("set label '") + (refused ? "cannot" : "failed") + "' at " +
           screen(area.left - 8, y, chart) + " right tc rgb " + colour + " font ',11'\n";
    for (const Point& p : curve.points) {
      if (!failed(p)) continue;
      // A failed case may lack its measured abscissa (CPU time): then its glyph stands at the edge.
      const double t = std::isfinite(p.x) ? chart.x.position(p.x * chart.x.quantity.scale) : 1;
      out += "set label " + gnuplot_string(status_style(p.record->status.kind).glyph) + " at " +
             screen(area.left + t * (area.right - area.left), y, chart) + " center tc rgb " +
             colour + " font ',13'\n";
    }
    y += kStripRow;
  }
  return out;
}

/// Exact zeros have no place on a logarithmic axis: they lie on its floor, which then says so.
std::string zero_label(const Chart& chart, const PlotArea& area) {
  const bool any =
      chart.y.log && chart.markers && std::ranges::any_of(chart.curves, [](const Curve& curve) {
        return std::ranges::any_of(curve.points,
                                   [](const Point& p) { return p.measured() && p.y <= 0; });
      });
  const double y = area.bottom - chart.y.position(floor_of(chart.y)) * (area.bottom - area.top);
  return any ? "set label '0' at " + screen(area.left - 9, y, chart) + " right tc rgb " +
                   paint("muted") + " font ',12'\n"
             : "";
}

std::string slope_text(double slope) {
  return slope == std::round(slope) ? significant(slope, 1) : significant(slope, 2);
}

/// y = c x^slope through a point below the lowest curve's beginning, and its label along it.
struct SlopeLine {
  std::string commands, plot;
};
SlopeLine slope_line(const Chart& chart, const PlotArea& area) {
  double c = std::numeric_limits<double>::infinity();
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points)
      if (p.measured() && p.y > 0 && p.x > 0)
        c = std::min(
            c, p.y * chart.y.quantity.scale / std::pow(p.x * chart.x.quantity.scale, *chart.slope));
  if (!std::isfinite(c)) return {};
  c *= 0.62;
  // The label hangs below the line, where the line is about a third on its way through the plot.
  const double low = chart.x.low, high = chart.x.high;
  const auto pixel = [&](double x) {
    const double y = c * std::pow(x, *chart.slope);
    const double ty = std::log(y / chart.y.low) / std::log(chart.y.high / chart.y.low);
    return std::pair(area.left + chart.x.position(x) * (area.right - area.left),
                     area.bottom - ty * (area.bottom - area.top));
  };
  double x = low * std::pow(high / low, 0.35);
  while (x > low * 1.05 && pixel(x).second > area.bottom - 40) x /= 1.1;
  const auto [x0, y0] = pixel(x);
  const auto [x1, y1] = pixel(x * 1.01);
  const double angle = std::atan2(y0 - y1, x1 - x0);
  SlopeLine line;
  line.commands = "set label 'theory: slope " + slope_text(*chart.slope) + "' at " +
                  screen(x0 + 11 * std::sin(angle), y0 + 11 * std::cos(angle), chart) +
                  " center rotate by " + exact(std::round(angle * 180 / std::numbers::pi)) +
                  " tc rgb " + paint("muted") + " font ',11'\n";
  line.plot = exact(c) + "*x**(" + exact(*chart.slope) + ") with lines dt (7,6) lw 1.2 lc rgb " +
              paint("axis") + " notitle";
  return line;
}

/// The reference's own error as a dotted line, or as a note on the axis if it lies below.
std::string floor_line(const Chart& chart, const PlotArea& area) {
  const double floor = *chart.floor * chart.y.quantity.scale;
  const bool below = floor < chart.y.low;
  const double t = below ? 0 : chart.y.position(std::min(floor, chart.y.high));
  const double y = area.bottom - t * (area.bottom - area.top);
  const std::string own = is_narrow(chart) ? "reference's: " : "reference's own error: ";
  const std::string where = is_narrow(chart) ? ", below" : ", below this plot";
  std::string out =
      "set label " +
      gnuplot_string(floor > 0 ? own + chart.y.quantity.text(*chart.floor, 2) + (below ? where : "")
                               : "the reference is exact") +
      " at " + screen(area.left + 8, y - 8, chart) + " left tc rgb " + paint("muted") +
      " font ',11'\n";
  if (!below)
    out += "set arrow from " + screen(area.left, y, chart) + " to " + screen(area.right, y, chart) +
           " nohead dt (2,4) lw 1.4 lc rgb " + paint("axis") + "\n";
  return out;
}

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
std::string plot_commands(const Chart& chart, const std::string& slope) {
  const std::string sx = exact(chart.x.quantity.scale);
  const std::string sy = exact(chart.y.quantity.scale);
  const std::string floor = exact(floor_of(chart.y));
  const std::string zero = chart.y.log ? "($4 <= 0 ? " + floor + " : $4*" + sy + ")" : "$4*" + sy;
  std::string out = "measured(s) = s eq 'ok' || s eq 'unsettled'\nplot 1/0 notitle";
  if (chart.stair && !pareto_front(chart.curves).empty())
    out += ", \\\n  '@CSV@' index " + std::to_string(chart.curves.size()) + " using ($3*" + sx +
           "):" + zero + " with steps lw 7 lc rgb " + paint("stair") + " notitle";
  if (!slope.empty()) out += ", \\\n  " + slope;
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

/// A rectangle on the picture [px] by its centre.
struct Box {
  double x, y, width, height;
  bool meets(const Box& o) const {
    return std::abs(x - o.x) < (width + o.width) / 2 && std::abs(y - o.y) < (height + o.height) / 2;
  }
};

Box marker_at(const Chart& chart, const PlotArea& area, const Point& p) {
  const double x = chart.x.position(p.x * chart.x.quantity.scale);
  const double y = chart.y.position(std::max(p.y * chart.y.quantity.scale, floor_of(chart.y)));
  return {area.left + x * (area.right - area.left), area.bottom - y * (area.bottom - area.top), 8,
          8};
}

std::vector<Box> markers_of(const Chart& chart, const PlotArea& area) {
  std::vector<Box> all;
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points)
      if (p.measured()) all.push_back(marker_at(chart, area, p));
  return all;
}

/// Where a text of this width beside a marker hides nothing of `taken`; nothing: nowhere.
std::optional<Box> free_place(const Box& marker, double width, const PlotArea& area,
                              const std::vector<Box>& taken) {
  const double side = width / 2 + 8;
  for (const auto& [dx, dy] : {std::pair(10.0, -11.0),
                               {-10.0, -11.0},
                               {10.0, 12.0},
                               {-10.0, 12.0},
                               {side, 0.0},
                               {-side, 0.0},
                               {side, -11.0},
                               {-side, 12.0}}) {
    const Box place{marker.x + dx, marker.y + dy, width, 11};
    if (place.x - width / 2 < area.left || place.x + width / 2 > area.right + 14) continue;
    if (place.y < area.top || place.y > area.bottom - 6) continue;
    if (std::ranges::none_of(taken, [&](const Box& o) { return place.meets(o); })) return place;
  }
  return {};
}

/// The settings beside their points, as many as find room; the table has them all.
std::string point_names(const Chart& chart, const PlotArea& area) {
  std::string out;
  std::vector<Box> taken = markers_of(chart, area);
  std::vector<std::pair<Box, std::string>> named;  // curves that coincide share a name
  for (const Curve& curve : chart.curves) {
    std::vector<const Point*> points;
    for (const Point& p : curve.points)
      if (p.measured() && std::isfinite(p.along)) points.push_back(&p);
    for (const Point* p : points) {
      const std::string name = p->name.empty() ? quantity("iterations").text(p->along, 2) : p->name;
      const Box marker = marker_at(chart, area, *p);
      if (std::ranges::any_of(named, [&](const auto& other) {
            return other.second == name && other.first.meets(marker);
          }))
        continue;
      const auto place = free_place(marker, text_width(name) * 11 / 12, area, taken);
      if (!place) continue;
      named.emplace_back(marker, name);
      taken.push_back(*place);
      out += "set label " + gnuplot_string(name) + " at " + screen(place->x, place->y, chart) +
             " center tc rgb " + quoted(solver_style(curve.solver).colour.light) +
             " font ',11' front\n";
    }
  }
  return out;
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

Drawing draw_chart(const Chart& chart) {
  Drawing drawing{"", make_csv(chart), describe(chart), make_table(chart), layout(chart)};
  const PlotArea& area = drawing.area;
  SlopeLine slope;
  if (chart.slope && chart.y.log) slope = slope_line(chart, area);
  drawing.script = script_preamble(chart.title, area, chart.width, chart.height) +
                   script_ticks("x", chart.x) + script_ticks("y", chart.y) +
                   axis_titles(chart, area) + end_labels(chart, area) + failure_strip(chart, area) +
                   zero_label(chart, area) + slope.commands;
  if (chart.name_points) drawing.script += point_names(chart, area);
  if (chart.floor && chart.y.log) drawing.script += floor_line(chart, area);
  drawing.script += plot_commands(chart, slope.plot);
  return drawing;
}

}  // namespace taut::report
