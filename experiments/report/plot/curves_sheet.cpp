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

/// Rows whose first column is this curve and whose status is, or is not, a failure.
std::string only(std::size_t curve, bool failures, const std::string& x, const std::string& y) {
  return "'@CSV@' skip 1 using (column(1) == " + std::to_string(curve) + " && strcol(8) eq '" +
         (failures ? "yes" : "no") + "' ? " + x + " : NaN):" + y;
}

/// What panels share, in shown units.
struct Frame {
  static constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  static constexpr double kDecades = 1e8;
  bool log_x = false, log_y = false;
  double left = kUnbounded, right = -kUnbounded;
  double least = 0;           ///< on a logarithmic axis of several panels: less is on the floor
  double floor = 0, top = 0;  ///< the ends of y

  explicit Frame(const std::vector<Chart>& charts) {
    const Unit &x = charts.front().x.unit, &y = charts.front().y.unit;
    const auto any_positive = [&](bool of_y) {
      return std::ranges::any_of(charts, [&](const Chart& chart) {
        return std::ranges::any_of(chart.curves, [&](const Curve& curve) {
          return std::ranges::any_of(
              curve.points, [&](const Point& p) { return p.measured() && (of_y ? p.y : p.x) > 0; });
        });
      });
    };
    log_x = x.logarithmic && any_positive(false);
    log_y = y.logarithmic && any_positive(true);
    std::vector<double> values;
    for (const Chart& chart : charts)
      for (const Curve& curve : chart.curves)
        for (const Point& p : curve.points) {
          if (std::isfinite(p.x) && (!log_x || p.x > 0)) {
            left = std::min(left, p.x * x.scale);
            right = std::max(right, p.x * x.scale);
          }
          if (p.measured() && (!log_y || p.y > 0)) values.push_back(p.y * y.scale);
        }
    set_range(values, charts.size() > 1);
    for (const Chart& chart : charts)  // else far below the picture
      if (chart.floor && chart.floor->y * y.scale > (log_y ? floor / 30 : 0))
        values.push_back(chart.floor->y * y.scale);
    set_range(values, charts.size() > 1);
  }

  void set_range(const std::vector<double>& values, bool several) {
    if (values.empty()) return;
    const double high = std::ranges::max(values);
    if (log_y && several) least = high / kDecades;
    double low = kUnbounded;
    for (const double v : values)
      if (!log_y || v >= least) low = std::min(low, v);
    const double air = log_y ? std::pow(high / low, 0.06) * 1.1 : 0;
    floor = log_y ? low / air : std::min(0.0, low);
    top = log_y ? high * air * air : high + 0.12 * (high - floor + (high == floor ? 1 : 0));
  }
};

/// Titles of the axes and scales; the ticks of a setting are the values that a study tried.
void set_axes(Sheet& sheet, const Frame& frame, const std::vector<Chart>& charts) {
  const Quantity &x = charts.front().x, &y = charts.front().y;
  sheet.x_label = x.label();
  sheet.y_label = y.label();
  for (const auto& [axis, log] : {std::pair("x", frame.log_x), {"y", frame.log_y}})
    if (log)
      sheet.settings += std::string("set logscale ") + axis + "\nset format " + axis + " '%g'\n";
  sheet.settings += "set yrange [" + exact(frame.floor) + ":" + exact(frame.top) + "]\n";
  std::set<double> ticks;
  for (const Chart& chart : charts) ticks.insert(chart.ticks.begin(), chart.ticks.end());
  const double air =
      frame.log_x ? std::pow(frame.right / frame.left, 0.06) : 0.05 * (frame.right - frame.left);
  if (frame.left < frame.right)
    sheet.settings += "set xrange [" + exact(frame.log_x ? frame.left / air : frame.left - air) +
                      ":" + exact(frame.log_x ? frame.right * air : frame.right + air) + "]\n";
  const std::size_t most = charts.size() > 1 ? 8 : 12;
  if (ticks.empty() || ticks.size() > most || !frame.log_x) return;
  sheet.settings +=
      "set xtics (" +
      join(ticks, ", ",
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
            std::string(to_string(r.status.kind)) + "," + csv_field(r.status.reason) + "," +
            (none ? "yes" : "no") + "," + csv_field(work_of(r).text()) + "," + csv_field(r.id) +
            "," + csv_field(r.scene) + "\n";
  }
  return rows;
}

/// How a failure is named above the plot: by the statuses that occur.
std::string ends_of(const std::vector<Chart>& charts) {
  std::vector<std::string> ends;
  for (const Chart& chart : charts)
    for (const Curve& curve : chart.curves)
      for (const Point& p : curve.points)
        if (failed(p)) push_unique(ends, std::string(to_string(p.record->status.kind)));
  return "above: " + joined(ends);
}

/// Numbers the labels of a solver: each has another dash, in every panel the same.
class Variants {
 public:
  std::string dash(const std::string& solver, const std::string& label) {
    std::vector<std::string>& own = labels_[solver];
    push_unique(own, label);
    return dash_of(solver, static_cast<int>(std::ranges::find(own, label) - own.begin()));
  }

 private:
  std::map<std::string, std::vector<std::string>> labels_;
};

/// x of the k-th of n curves that fail in a panel: their marks stand beside each other.
std::string beside(const std::string& x, const Frame& frame, std::size_t k, std::size_t n) {
  const double share = 0.022 * (static_cast<double>(k) - 0.5 * static_cast<double>(n - 1));
  if (n < 2 || !(frame.left < frame.right)) return x;
  return frame.log_x ? x + "*" + exact(std::pow(frame.right / frame.left, share))
                     : x + "+(" + exact(share * (frame.right - frame.left)) + ")";
}

/// One curve in the last panel: its points, what failed on the upper edge, what is too small for a
/// logarithmic axis on the lower one. What these marks mean goes to `marks`: look and title.
void draw_curve(Sheet& sheet, std::size_t id, const Curve& curve, const Chart& chart,
                const Frame& frame, const std::string& dash, const std::string& ends,
                std::vector<std::pair<std::string, std::string>>& marks) {
  const std::string colour = " lc rgb '" + colour_of(curve.solver) + "'";
  const std::string x = "column(4)*" + exact(chart.x.unit.scale),
                    y = "column(5)*" + exact(chart.y.unit.scale);
  const auto low = [&](const Point& p) {
    return frame.log_y && !failed(p) && p.y >= 0 &&
           (p.y == 0 || p.y * chart.y.unit.scale < frame.least);
  };
  const std::string drawn =
      frame.least > 0 ? "column(5) > 0 && " + y + " >= " + exact(frame.least) : "column(5) > 0";
  sheet.draw(only(id, false, x, frame.log_y ? "(" + drawn + " ? " + y + " : NaN)" : "(" + y + ")"),
             (chart.join ? "with linespoints" : "with points") + colour + " dt " + dash + " pt " +
                 std::string(solver_style(curve.solver).marker),
             curve.label);
  if (std::ranges::any_of(curve.points, failed)) {
    std::vector<const Curve*> failing;
    for (const Curve& other : chart.curves)
      if (std::ranges::any_of(other.points, failed)) failing.push_back(&other);
    const auto place = std::ranges::find(failing, &curve) - failing.begin();
    sheet.draw(only(id, true, beside(x, frame, static_cast<std::size_t>(place), failing.size()),
                    "(" + exact(frame.top) + ")"),
               "with points pt 2 ps 1.2 lw 2" + colour, "");
    marks.push_back({std::string("with points pt 2 ps 1.2 lw 2") + kGrey, ends});
  }
  if (!std::ranges::any_of(curve.points, low)) return;
  sheet.draw(
      only(id, false, x, "(column(5) >= 0 && !(" + drawn + ") ? " + exact(frame.floor) + " : NaN)"),
      "with points pt 10 ps 1.2" + colour, "");
  marks.push_back({std::string("with points pt 10 ps 1.2") + kGrey,
                   frame.least > 0 ? "below: zero, or less than " + significant(frame.least, 1)
                                   : "below: exactly zero"});
}

/// What is no curve: the theory's slope, the value's floor, the Pareto front.
void draw_guides(Sheet& sheet, const Chart& chart, const Frame& frame) {
  const double x = chart.x.unit.scale, y = chart.y.unit.scale;
  if (const double factor = theory_factor(chart); std::isfinite(factor) && frame.left < frame.right)
    sheet.draw("[" + exact(frame.left) + ":" + exact(frame.right) + "] " + exact(factor * y) +
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

Sheet curves_sheet(const std::vector<Chart>& charts) {
  Sheet sheet;
  const Frame frame(charts);
  set_axes(sheet, frame, charts);
  sheet.csv = kPointColumns;
  const std::string ends = ends_of(charts);
  Variants variants;
  std::vector<std::pair<std::string, std::string>> marks;
  std::size_t id = 0;
  for (const Chart& chart : charts) {
    sheet.panels.push_back({chart.title, "", ""});
    for (const Curve& curve : chart.curves) {
      sheet.csv += csv_rows(id, curve);
      draw_curve(sheet, id++, curve, chart, frame, variants.dash(curve.solver, curve.label), ends,
                 marks);
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
  double low = 0, high = 0;
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
      for (const double v : series.y)
        if (std::isfinite(v)) {
          low = std::min(low, v);
          high = std::max(high, v);
        }
      sheet.draw(only(id++, false, "column(4)", "(column(5)*" + exact(y.unit.scale) + ")"),
                 "with lines lw 1.5 lc rgb '" + colour_of(series.solver) + "' dt " +
                     variants.dash(series.solver, series.label),
                 series.label);
      chart.series.push_back(series);
    }
    add_floor(chart);
    draw_guides(sheet, chart, Frame({chart}));
  }
  if (panels.size() > 1 && low < high)
    sheet.settings += "set yrange [" + exact(low * y.unit.scale) + ":" +
                      exact(1.05 * high * y.unit.scale) + "]\n";
  return sheet;
}

}  // namespace taut::report
