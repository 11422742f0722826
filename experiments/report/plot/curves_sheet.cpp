// Curves over a setting, a cost or time.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "core/model/text.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/plot/sheet.hpp"
#include "experiments/system/distinct.hpp"

namespace taut::report {

namespace {

constexpr const char* kGrey = " lc rgb '#5B6472'";

/// Data of a curve: the rows that are failures, or those that are not.
std::string only(std::size_t curve, bool failures, const std::string& x, const std::string& y) {
  return "'@CSV@' skip 1 using (column(1) == " + std::to_string(curve) + " && strcol(8) eq '" +
         (failures ? "yes" : "no") + "' ? " + x + " : NaN):" + y;
}

/// Ticks at 1, 2 and 5 on a logarithmic axis that has at most one power of ten; "" if it has more.
std::string few_decades(const std::string& axis, const Scale& scale) {
  if (std::floor(std::log10(scale.high)) > std::ceil(std::log10(scale.low))) return "";
  std::vector<std::string> ticks;
  for (double power = std::pow(10, std::floor(std::log10(scale.low))); power <= scale.high;
       power *= 10)
    for (const double tick : {power, 2 * power, 5 * power})
      if (tick >= scale.low && tick <= scale.high)
        ticks.push_back(gnuplot_string(significant(tick, 1)) + " " + exact(tick));
  return "set " + axis + "tics (" + join(ticks, ", ") + ")\n";
}

/// Sets titles, scales and ticks of the axes. The ticks of a setting are the values that a study
/// tried.
void set_axes(Sheet& sheet, const Frame& frame, const std::vector<Chart>& charts) {
  const Quantity &x = charts.front().x, &y = charts.front().y;
  sheet.x_label = x.label();
  sheet.y_label = y.label();
  std::set<double> tried;
  for (const Chart& chart : charts) tried.insert(chart.ticks.begin(), chart.ticks.end());
  const std::size_t most = charts.size() > 1 ? 8 : 12;
  if (tried.size() > most || !frame.x.logarithmic) tried.clear();
  for (const auto& [axis, scale] : {std::pair("x", frame.x), {"y", frame.y}}) {
    const bool is_x = std::string_view(axis) == "x";
    if (scale.logarithmic)
      sheet.settings += std::string("set logscale ") + axis + "\nset format " + axis + " '%g'\n" +
                        (is_x && !tried.empty() ? "" : few_decades(axis, scale));
    sheet.settings +=
        std::string("set ") + axis + "range [" + exact(scale.low) + ":" + exact(scale.high) + "]\n";
  }
  if (tried.empty()) return;
  sheet.settings +=
      "set xtics (" +
      join(tried, ", ",
           [&](double tick) {
             return gnuplot_string(tick_of(x, tick)) + " " + exact(tick * x.unit.scale);
           }) +
      ")\n";
}

constexpr const char* kPointColumns =
    "curve,solver,label,x,y,status,reason,failed,setting,case,scene\n";

std::string csv_rows(std::size_t id, const Curve& curve) {
  std::string rows;
  for (const Point& p : curve.points) {
    const Record& r = *p.record;
    const bool none = failed(p);
    rows += std::to_string(id) + "," + csv_field(curve.solver) + "," + csv_field(curve.label) +
            "," + exact(p.x) + "," + (none ? "" : exact(p.y)) + "," +
            std::string(to_string(r.status.kind)) + "," + csv_field(r.status.reason.text()) + "," +
            (none ? "yes" : "no") + "," + csv_field(work_of(r).text()) + "," + csv_field(r.id) +
            "," + csv_field(r.scene) + "\n";
  }
  return rows;
}

/// Name of failures above the plot: the statuses that occur.
std::string ends_of(const std::vector<Chart>& charts) {
  std::vector<std::string> ends;
  for (const Chart& chart : charts)
    for (const Curve& curve : chart.curves)
      for (const Point& p : curve.points)
        if (failed(p)) push_unique(ends, std::string(to_string(p.record->status.kind)));
  return "above: " + joined(ends);
}

/// x of the k-th of n curves that fail in a panel, shifted so that their marks are side by side.
std::string beside(const std::string& x, const Frame& frame, std::size_t k, std::size_t n) {
  const double share = 0.022 * (static_cast<double>(k) - 0.5 * static_cast<double>(n - 1));
  if (n < 2) return x;
  return frame.x.logarithmic ? x + "*" + exact(std::pow(frame.x.high / frame.x.low, share))
                             : x + "+(" + exact(share * (frame.x.high - frame.x.low)) + ")";
}

/// Draws one curve in the last panel: its points, failures on the upper edge, and values too small
/// for a logarithmic axis on the lower edge. Adds the look and title of these marks to `marks`.
void draw_curve(Sheet& sheet, std::size_t id, const Curve& curve, const Chart& chart,
                const Frame& frame, const std::string& ends,
                std::vector<std::pair<std::string, std::string>>& marks) {
  const std::string colour = " lc rgb '" + colour_of(curve.solver) + "'";
  const std::string x = "column(4)*" + exact(chart.x.unit.scale),
                    y = "column(5)*" + exact(chart.y.unit.scale);
  const auto low = [&](const Point& p) { return on_axis(p, chart.y.unit, frame); };
  const std::string drawn = "column(5) > 0 && " + y + " >= " + exact(frame.least);
  sheet.draw(
      only(id, false, x, frame.y.logarithmic ? "(" + drawn + " ? " + y + " : NaN)" : "(" + y + ")"),
      (chart.join ? "with linespoints" : "with points") + colour + " dt " +
          gnuplot_dash(curve.solver, curve.variant) + " pt " +
          std::string(solver_style(curve.solver).marker),
      curve.label);
  if (std::ranges::any_of(curve.points, failed)) {
    std::vector<const Curve*> failing;
    for (const Curve& other : chart.curves)
      if (std::ranges::any_of(other.points, failed)) failing.push_back(&other);
    const auto place = std::ranges::find(failing, &curve) - failing.begin();
    sheet.draw(only(id, true, beside(x, frame, static_cast<std::size_t>(place), failing.size()),
                    "(" + exact(frame.y.high) + ")"),
               "with points pt 2 ps 1.2 lw 2" + colour, "");
    marks.push_back({std::string("with points pt 2 ps 1.2 lw 2") + kGrey, ends});
  }
  if (!std::ranges::any_of(curve.points, low)) return;
  sheet.draw(
      only(id, false, x, "(column(5) >= 0 && !(" + drawn + ") ? " + exact(frame.y.low) + " : NaN)"),
      "with points pt 10 ps 1.2" + colour, "");
  const bool zeros =
      std::ranges::all_of(curve.points, [&](const Point& p) { return !low(p) || p.y == 0; });
  marks.push_back(
      {std::string("with points pt 10 ps 1.2") + kGrey,
       zeros ? "below: exactly zero" : "below: zero, or less than " + significant(frame.least, 1)});
}

/// Draws everything that is not a curve: the slope of a theory, the floor of the value, the Pareto
/// front.
void draw_guides(Sheet& sheet, const Chart& chart, const Frame& frame) {
  const double x = chart.x.unit.scale, y = chart.y.unit.scale;
  if (const double factor = theory_factor(chart); std::isfinite(factor))
    sheet.draw("[" + exact(frame.x.low) + ":" + exact(frame.x.high) + "] " + exact(factor * y) +
                   "*(x/" + exact(x) + ")**" + exact(*chart.slope),
               std::string("with lines dt (4,4)") + kGrey, theory_text(chart));
  if (chart.floor)
    sheet.draw(exact(chart.floor->y * y), std::string("with lines dt (1,3)") + kGrey,
               chart.floor->text + ", " + chart.y.text(chart.floor->y));
  if (!chart.front) return;
  const std::string name = "$front" + std::to_string(sheet.panels.size());
  std::string& settings = sheet.panels.back().settings;
  settings += name + " << EOD\n";
  for (const Point& p : pareto_front(chart))
    settings += exact(p.x * x) + " " + exact(p.y * y) + "\n";
  settings += "EOD\n";
  sheet.draw(name + " using 1:2", "with steps lc rgb '#9BA5B3'", "Pareto front");
}

}  // namespace

Sheet curves_sheet(const Figure& figure) {
  Sheet sheet;
  const std::vector<Chart>& charts = figure.charts;
  const Frame frame = frame_of(charts, is_logarithmic(charts));
  set_axes(sheet, frame, charts);
  sheet.csv = kPointColumns;
  const std::string ends = ends_of(charts);
  std::vector<std::pair<std::string, std::string>> marks;
  std::size_t id = 0;
  for (const Chart& chart : charts) {
    sheet.panels.push_back({chart.title, "", ""});
    for (const Curve& curve : chart.curves) {
      sheet.csv += csv_rows(id, curve);
      draw_curve(sheet, id++, curve, chart, frame, ends, marks);
    }
    draw_guides(sheet, chart, frame);
  }
  for (const auto& [look, title] : marks) sheet.explain(look, title);
  return sheet;
}

Sheet series_sheet(const std::vector<PlotPanel>& panels, const std::string& value) {
  Sheet sheet;
  const Quantity x = quantity("t"), y = quantity(value);
  sheet.x_label = x.label();
  sheet.y_label = y.label();
  sheet.csv = kPointColumns;
  Variants variants;
  std::vector<double> values{0};
  std::size_t id = 0;
  for (const PlotPanel& panel : panels) {
    Chart chart{.id = {}, .scene = {}, .kind = {}, .title = {}, .x = x, .y = y};
    sheet.panels.push_back({panel.title, "", ""});
    for (const TimeSeries& series : panel.series) {
      if (series.value != value) continue;
      for (std::size_t k = 0; k < series.t.size(); ++k)
        sheet.csv += std::to_string(id) + "," + csv_field(series.solver) + "," +
                     csv_field(series.label) + "," + exact(series.t[k]) + "," + exact(series.y[k]) +
                     ",ok,,no,," + csv_field(series.key) + "," + csv_field(series.scene) + "\n";
      for (const double v : series.y) values.push_back(v * y.unit.scale);
      sheet.draw(only(id++, false, "column(4)", "(column(5)*" + exact(y.unit.scale) + ")"),
                 "with lines lw 1.5 lc rgb '" + colour_of(series.solver) + "' dt " +
                     gnuplot_dash(series.solver, variants.of(series.solver, series.label)),
                 series.label);
      chart.series.push_back(series);
    }
    add_floor(chart);
    draw_guides(sheet, chart, frame_of({&chart, 1}, false));
  }
  const Scale scale = scale_of(false, values);
  sheet.settings += "set yrange [" + exact(scale.low) + ":" + exact(scale.high) + "]\n";
  return sheet;
}

}  // namespace taut::report
