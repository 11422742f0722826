#include "experiments/report/plot/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/files.hpp"
#include "experiments/timing/profile.hpp"

namespace taut::report {

namespace {

/// The first value with this role.
std::string_view value_with(Role role) {
  const std::vector<const ValueSpec*> all = values_with_role();
  const auto at = std::ranges::find(all, role, &ValueSpec::role);
  return at == all.end() ? "" : (*at)->name;
}

std::string colour_of(std::string_view solver) {
  return std::string(solver_style(solver).colour.light);
}

/// A dash pattern for gnuplot: "9 4" -> "(9,4)"; the variants of one solver get others.
std::string dash_of(std::string_view solver, int variant) {
  constexpr std::array<std::string_view, 5> kVariants{"7 4", "2 3", "10 3 2 3", "16 4", "4 2"};
  std::string dash(variant == 0 ? solver_style(solver).dash
                                : kVariants[static_cast<std::size_t>(variant - 1) % 5]);
  if (dash.empty()) return "solid";
  std::ranges::replace(dash, ' ', ',');
  return "(" + dash + ")";
}

/// A figure: the rows of its CSV, panels on the same axes, one key for all. Titles and labels reach
/// the script by gnuplot_string() alone.
struct Sheet {
  struct Panel {
    std::string title, settings, plot;
  };
  std::string csv, settings, x_label, y_label;
  std::vector<Panel> panels;
  std::vector<std::string> key, titles;  ///< of each look that the panels have: once

  /// Draws data into the last panel. A look without a title is not in the key.
  void draw(const std::string& data, const std::string& look, const std::string& title) {
    std::string& plot = panels.back().plot;
    plot += (plot.empty() ? "plot " : ", \\\n  ") + data + " " + look + " notitle";
    explain(look, title);
  }
  void explain(const std::string& look, const std::string& title) {
    const std::string entry = look + " title " + gnuplot_string(title);
    if (title.empty() || std::ranges::find(key, entry) != key.end()) return;
    key.push_back(entry), titles.push_back(title);
  }
};

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
    log_x = x.logarithmic && any_positive(false), log_y = y.logarithmic && any_positive(true);
    std::vector<double> values;
    for (const Chart& chart : charts)
      for (const Curve& curve : chart.curves)
        for (const Point& p : curve.points) {
          if (std::isfinite(p.x) && (!log_x || p.x > 0))
            left = std::min(left, p.x * x.scale), right = std::max(right, p.x * x.scale);
          if (p.measured() && (!log_y || p.y > 0)) values.push_back(p.y * y.scale);
        }
    set_range(values, charts.size() > 1);
    for (const Chart& chart : charts)  // else far below the picture
      if (chart.floor && chart.floor->y * y.scale > (log_y ? floor / 10 : 0))
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
    floor = log_y ? low / 3 : std::min(0.0, low);
    top = log_y ? high * 3 : high + 0.12 * (high - floor + (high == floor ? 1 : 0));
  }
};

/// Titles of the axes and scales; the ticks of a setting are the values that a study tried.
void set_axes(Sheet& sheet, const Frame& frame, const std::vector<Chart>& charts) {
  const Quantity &x = charts.front().x, &y = charts.front().y;
  sheet.x_label = x.label(), sheet.y_label = y.label();
  for (const auto& [axis, log] : {std::pair("x", frame.log_x), {"y", frame.log_y}})
    if (log)
      sheet.settings += std::string("set logscale ") + axis + "\nset format " + axis + " '%g'\n";
  sheet.settings += "set yrange [" + exact(frame.floor) + ":" + exact(frame.top) + "]\n";
  std::set<double> ticks;
  for (const Chart& chart : charts) ticks.insert(chart.ticks.begin(), chart.ticks.end());
  const double air =
      frame.log_x ? std::pow(frame.right / frame.left, 0.05) : 0.04 * (frame.right - frame.left);
  if (charts.size() > 1 && frame.left < frame.right)
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

/// One curve in the last panel: its points, what failed on the upper edge, what is too small for a
/// logarithmic axis on the lower one.
void draw_curve(Sheet& sheet, std::size_t id, const Curve& curve, const Chart& chart,
                const Frame& frame, const std::string& dash, const std::string& ends) {
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
                 std::to_string(solver_style(curve.solver).marker),
             curve.label);
  if (std::ranges::any_of(curve.points, failed)) {
    sheet.draw(only(id, true, x, "(" + exact(frame.top) + ")"),
               "with points pt 2 ps 1.2 lw 2" + colour, "");
    sheet.explain(std::string("with points pt 2 ps 1.2 lw 2") + kGrey, ends);
  }
  if (!std::ranges::any_of(curve.points, low)) return;
  sheet.draw(
      only(id, false, x, "(column(5) >= 0 && !(" + drawn + ") ? " + exact(frame.floor) + " : NaN)"),
      "with points pt 10 ps 1.2" + colour, "");
  sheet.explain(std::string("with points pt 10 ps 1.2") + kGrey,
                frame.least > 0 ? "below: zero, or less than " + significant(frame.least, 1)
                                : "below: exactly zero");
}

/// What is no curve: the theory's slope, the value's floor, the Pareto front.
void draw_guides(Sheet& sheet, const Chart& chart, const Frame& frame) {
  const double x = chart.x.unit.scale, y = chart.y.unit.scale;
  if (const double factor = theory_factor(chart); std::isfinite(factor) && frame.left < frame.right)
    sheet.draw("[" + exact(frame.left) + ":" + exact(frame.right) + "] " + exact(factor * y) +
                   "*(x/" + exact(x) + ")**" + exact(*chart.slope),
               std::string("with lines dt (4,4)") + kGrey, "theory: slope " + exact(*chart.slope));
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

Sheet curves_sheet(const std::vector<Chart>& charts) {
  Sheet sheet;
  const Frame frame(charts);
  set_axes(sheet, frame, charts);
  sheet.csv = kPointColumns;
  const std::string ends = ends_of(charts);
  Variants variants;
  std::size_t id = 0;
  for (const Chart& chart : charts) {
    sheet.panels.push_back({chart.title, "", ""});
    for (const Curve& curve : chart.curves) {
      sheet.csv += csv_rows(id, curve);
      draw_curve(sheet, id++, curve, chart, frame, variants.dash(curve.solver, curve.label), ends);
    }
    draw_guides(sheet, chart, frame);
  }
  return sheet;
}

Sheet series_sheet(const std::vector<PlotPanel>& panels, const std::string& value) {
  Sheet sheet;
  const Quantity x = quantity("t"), y = quantity(value);
  sheet.x_label = x.label(), sheet.y_label = y.label();
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
        if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
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

/// "set xtics (...)" and the range of cells that are one apart.
std::string cell_ticks(const char* axis, const Quantity& q, const std::vector<double>& values) {
  std::string list;
  for (std::size_t k = 0; k < values.size(); ++k)
    list += (k > 0 ? ", " : "") + gnuplot_string(tick_of(q, values[k])) + " " + std::to_string(k);
  return "set " + std::string(axis) + "tics (" + list + ")\nset " + axis +
         "range [-0.5:" + exact(static_cast<double>(values.size()) - 0.5) + "]\n";
}

Sheet map_sheet(const std::vector<StatusMap>& maps) {
  Sheet sheet;
  sheet.x_label = maps.front().x.label(), sheet.y_label = maps.front().y.label();
  sheet.csv = "curve,solver,label,x,y,column,row,status,reason,case\n";
  std::set<Status::Kind> kinds;
  for (const StatusMap& map : maps)
    for (const StatusMap::Cell& cell : map.cells) kinds.insert(cell.record->status.kind);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const StatusMap& map = maps[i];
    for (const StatusMap::Cell& cell : map.cells)
      sheet.csv += std::to_string(i) + "," + csv_field(map.solver) + "," + csv_field(map.label) +
                   "," + exact(map.columns[cell.column]) + "," + exact(map.rows[cell.row]) + "," +
                   std::to_string(cell.column) + "," + std::to_string(cell.row) + "," +
                   std::string(to_string(cell.record->status.kind)) + "," +
                   csv_field(cell.record->status.reason) + "," + csv_field(cell.record->id) + "\n";
    sheet.panels.push_back(
        {map.label, cell_ticks("x", map.x, map.columns) + cell_ticks("y", map.y, map.rows), ""});
    for (const Status::Kind kind : kinds) {
      const StatusStyle style = status_style(kind);
      const std::string cells = "'@CSV@' skip 1 using (column(1) == " + std::to_string(i) +
                                " && strcol(8) eq '" + std::string(to_string(kind)) +
                                "' ? column(6) : NaN):7:";
      sheet.draw(
          cells + "(0.45):(0.45)",
          "with boxxyerror fs solid 1 noborder lc rgb '" + std::string(style.colour.light) + "'",
          std::string(to_string(kind)));
      sheet.draw(cells + "(" + gnuplot_string(style.glyph) + ")",
                 "with labels tc rgb '" + std::string(style.ink.light) + "'", "");
    }
  }
  return sheet;
}

Sheet profile_sheet(const std::vector<PerformanceProfile>& profiles) {
  Sheet sheet;
  double most = 2;  // of the finite factors
  for (const PerformanceProfile& profile : profiles)
    for (const double r : profile.ratios)
      if (std::isfinite(r)) most = std::max(most, r);
  sheet.x_label = "CPU time over that of the cheapest solver";
  sheet.y_label = "share of problems [%]";
  sheet.settings = "set logscale x\nset xrange [1:" + exact(1.1 * most) + "]\nset yrange [0:105]\n";
  sheet.csv = "curve,solver,factor,share\n";
  sheet.panels.emplace_back();
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    const PerformanceProfile& profile = profiles[i];
    std::set<double> factors{1, 1.1 * most};
    for (const double r : profile.ratios)
      if (std::isfinite(r)) factors.insert(r);
    for (const double factor : factors)
      sheet.csv += std::to_string(i) + "," + csv_field(profile.solver) + "," + exact(factor) + "," +
                   exact(profile.share(factor)) + "\n";
    sheet.draw("'@CSV@' skip 1 using (column(1) == " + std::to_string(i) +
                   " ? column(3) : NaN):(100*column(4))",
               "with steps lw 2 lc rgb '" + colour_of(profile.solver) + "' dt " +
                   dash_of(profile.solver, 0),
               solver_title(profile.solver));
  }
  return sheet;
}

/// Where the panels and the key of a figure stand [px].
struct Layout {
  std::size_t panels, columns, rows;
  std::size_t key = 0, width, height;

  explicit Layout(const Sheet& sheet)
      : panels(sheet.panels.size()),
        columns(panels < 2    ? 1
                : panels < 5  ? 2
                : panels < 10 ? 3
                              : 4),
        rows((panels + columns - 1) / columns) {
    for (const std::string& title : sheet.titles) {
      const auto letters = static_cast<std::size_t>(
          std::ranges::count_if(title, [](char c) { return (c & 0xC0) != 0x80; }));
      key = std::max(key, 75 + 7 * letters);
    }
    width = (panels > 1 ? 310 * columns : 680) + key, height = (panels > 1 ? 250 * rows : 440) + 80;
  }
  double right() const { return 1 - static_cast<double>(key + 10) / static_cast<double>(width); }
  double top() const { return 1 - (panels > 1 ? 70.0 : 50.0) / static_cast<double>(height); }
};

/// A panel beside others shows the axes' titles at the figure's edge alone.
std::string panel_commands(const Sheet& sheet, const Layout& layout, std::size_t at) {
  const Sheet::Panel& panel = sheet.panels[at];
  const bool first = at % layout.columns == 0, last = at + layout.columns >= layout.panels;
  return "set title " + gnuplot_string(layout.panels > 1 ? panel.title : "") + "\nset xlabel " +
         gnuplot_string(last ? sheet.x_label : "") + "\nset ylabel " +
         gnuplot_string(first ? sheet.y_label : "") + "\n" + panel.settings + panel.plot + "\n";
}

std::string script(const PlotSpec& spec, const Sheet& sheet, const Layout& layout) {
  const std::string right = exact(layout.right()), top = exact(layout.top());
  std::string text =
      "# " + spec.kind + ": " + spec.y + " over " + spec.x +
      "\n# Again: gnuplot -e \"set terminal svg noenhanced size " + std::to_string(layout.width) +
      "," + std::to_string(layout.height) + "; set output '" + spec.file + ".svg'\" " + spec.file +
      ".gp\nset encoding utf8\nset datafile separator ','\nunset key\n"
      "set offsets graph 0.04, graph 0.04, 0, 0\nset grid lc rgb '#E5E7EB'\n"
      "set border 3\nset tics nomirror\n" +
      sheet.settings + "set multiplot layout " + std::to_string(layout.rows) + "," +
      std::to_string(layout.columns) + " title " + gnuplot_string(spec.title) +
      " margins char 10, screen " + right + ", char 4, screen " + top + " spacing char 8, char 4\n";
  for (std::size_t i = 0; i < sheet.panels.size(); ++i) text += panel_commands(sheet, layout, i);
  text +=
      "# The key of all panels.\nreset\nset border 0\nunset tics\nset margins 0, 0, 0, 0\n"
      "set origin " +
      right + ", 0\nset key at screen " + right + ", screen " + top +
      " left top Left reverse\nplot [0:1][0:1] NaN notitle";
  for (const std::string& entry : sheet.key) text += ", \\\n  keyentry " + entry;
  text += "\nunset multiplot\n";
  for (std::size_t at; (at = text.find("@CSV@")) != std::string::npos;)
    text.replace(at, 5, spec.file + ".csv");
  return text;
}

PlotFiles write_plot(const PlotSpec& spec, const Sheet& sheet,
                     const std::filesystem::path& folder) {
  make_folder(folder);
  const auto path = [&](const char* extension) { return folder / (spec.file + extension); };
  PlotFiles files{path(".svg"), path(".pdf"), path(".gp"), path(".csv"), {}};
  const Layout layout(sheet);
  write_file(files.csv, sheet.csv);
  write_file(files.gp, script(spec, sheet, layout));
  const auto size = [&](double scale, const char* unit) {
    return exact(static_cast<double>(layout.width) * scale) + unit + "," +
           exact(static_cast<double>(layout.height) * scale) + unit;
  };
  run_gnuplot(files.gp,
              "svg noenhanced size " + size(1, "") + " font 'sans-serif,13' background '#ffffff'",
              files.svg);
  run_gnuplot(files.gp,
              "pdfcairo noenhanced size " + size(0.01, "in") + " font 'sans,13' fontscale 0.72",
              files.pdf);
  return files;
}

}  // namespace

std::span<const PlotKind> plot_kinds() {
  static const std::array kKinds{
      PlotKind{"contact", kSweeps, value_with(Role::vertex_depth), kSweeps},
      PlotKind{"convergence", kSweeps, kErrorMetric, kSweeps},
      PlotKind{"profile", "cpu.per_second", kErrorMetric, "setting"},  // Dolan and More
      PlotKind{"scaling", "vertices", "cpu.per_step", "vertices"},
      PlotKind{"series", "t", kErrorMetric, "t"},
      PlotKind{"stability", "dt", kSweeps, "dt"},
      PlotKind{"work-precision", "projections", kErrorMetric, "setting"},
  };
  return kKinds;
}

const PlotKind& find_plot_kind(std::string_view name) {
  std::vector<std::string> names;
  for (const PlotKind& kind : plot_kinds()) {
    if (kind.name == name) return kind;
    names.emplace_back(kind.name);
  }
  throw InputError("unknown kind of plot '" + std::string(name) + "'" +
                   suggestion(std::string(name), names));
}

void check_value_name(const std::string& name, const Records& records) {
  std::vector<std::string> known = quantity_names();
  known.emplace_back("setting");
  for (const Record* r : records) {
    if (std::isfinite(value_of(*r, name))) return;
    for (const auto& [param, value] : r->params) known.push_back(param);
  }
  if (std::ranges::find(known, name) == known.end())
    throw InputError("unknown value '" + name + "'" + suggestion(name, known) +
                     " (`taut list metrics`)");
}

namespace {

/// The sheet of what can be drawn; why of the other panels nothing can goes to `without`. Throws
/// InputError if nothing can.
Sheet sheet_of(const PlotSpec& spec, const std::vector<PlotPanel>& panels,
               std::vector<std::string>& without) {
  std::vector<Chart> charts;
  std::vector<StatusMap> maps;
  std::vector<PlotPanel> series;
  for (const PlotPanel& panel : panels) try {
      if (spec.kind == "series") {
        if (std::ranges::find(panel.series, spec.y, &TimeSeries::value) == panel.series.end())
          throw InputError("no series of '" + spec.y + "' was recorded");
        series.push_back(panel);
      } else if (spec.kind == "stability") {
        if (panel.records.empty()) throw InputError("there is no case to draw");
        std::ranges::move(make_maps(panel.records, panel.records.front()->scene, spec.x, spec.y),
                          std::back_inserter(maps));
      } else {
        Chart chart = make_chart(spec.kind, panel.records, spec.x, spec.y, spec.along);
        add_floor(chart);
        chart.title = panel.title;
        chart.slope = panel.slope, chart.front = spec.kind == "work-precision";
        charts.push_back(std::move(chart));
      }
    } catch (const InputError& error) {
      without.push_back(panel.title + (panel.title.empty() ? "" : ": ") + error.what());
    }
  if (series.empty() && maps.empty() && charts.empty())
    throw InputError(without.empty() ? "there is nothing to draw" : without.front());
  return !series.empty() ? series_sheet(series, spec.y)
         : !maps.empty() ? map_sheet(maps)
                         : curves_sheet(charts);
}

}  // namespace

PlotFiles make_plot(PlotSpec spec, const std::vector<PlotPanel>& panels,
                    const std::filesystem::path& folder) {
  const PlotKind& kind = find_plot_kind(spec.kind);
  if (spec.x.empty()) spec.x = kind.x;
  if (spec.y.empty()) spec.y = kind.y;
  if (spec.along.empty())
    spec.along =
        spec.x == "dt" || spec.x == kSubsteps || spec.x == "vertices" ? spec.x : kind.along;
  Records all;
  for (const PlotPanel& panel : panels)
    all.insert(all.end(), panel.records.begin(), panel.records.end());
  for (const std::string& name : {spec.x, spec.y}) check_value_name(name, all);
  if (spec.file.empty()) spec.file = slug(spec.kind + "-" + spec.y + "-over-" + spec.x);
  std::vector<std::string> without;
  const Sheet sheet = sheet_of(spec, panels, without);
  PlotFiles files = write_plot(spec, sheet, folder);
  files.without = std::move(without);
  return files;
}

PlotFiles make_profile_plot(PlotSpec spec, const StudyBench& bench,
                            const std::filesystem::path& folder) {
  const PlotKind& kind = find_plot_kind("profile");
  spec.x = kind.x;
  if (spec.y.empty()) spec.y = kind.y;
  if (spec.file.empty()) spec.file = slug("profile-" + spec.y);
  const std::vector<PerformanceProfile> profiles = performance_profiles(bench.scenes, spec.y);
  if (profiles.empty() || profiles.front().ratios.empty())
    throw InputError("no setting of any solver reaches an error of " + spec.y +
                     " that is asked for");
  return write_plot(spec, profile_sheet(profiles), folder);
}

}  // namespace taut::report
