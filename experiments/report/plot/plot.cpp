#include "experiments/report/plot/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "core/model/input_error.hpp"
#include "core/model/solver.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/process.hpp"
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

/// One plot: rows of the CSV, and the commands that draw them. Titles and labels reach the script
/// by gnuplot_string() alone.
struct Sheet {
  std::string csv, settings, plot;

  void draw(const std::string& what) { plot += (plot.empty() ? "plot " : ", \\\n  ") + what; }
};

/// Rows whose first column is this curve and whose status is, or is not, a failure.
std::string only(std::size_t curve, bool failures, const char* x, const char* y) {
  return "'@CSV@' skip 1 using (column(1) == " + std::to_string(curve) + " && strcol(8) eq '" +
         (failures ? "yes" : "no") + "' ? " + x + " : NaN):" + y;
}

std::string axis_commands(const char* axis, const Quantity& q, bool logarithmic) {
  const std::string name(axis);
  return "set " + name + "label " + gnuplot_string(q.label()) + "\n" +
         (logarithmic ? "set logscale " + name + "\nset format " + name + " '%g'\n" : "");
}

/// Whether every value can stand on a logarithmic axis but exact zeros, which lie on its floor.
bool any_positive(const Chart& chart, bool of_y) {
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points)
      if (p.measured() && (of_y ? p.y : p.x) > 0) return true;
  return false;
}

/// The chart's floor as a line from edge to edge.
std::string floor_line(const Chart::Floor& floor, const Quantity& y) {
  return exact(floor.y * y.unit.scale) + " with lines dt (1,3) lc rgb '#5B6472' title " +
         gnuplot_string(floor.text + ", " + y.text(floor.y));
}

Sheet curves_sheet(const Chart& chart, const std::string& title) {
  Sheet sheet;
  const bool log_x = chart.x.unit.logarithmic && any_positive(chart, false),
             log_y = chart.y.unit.logarithmic && any_positive(chart, true);
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  double low = kUnbounded, high = -kUnbounded, left = kUnbounded, right = -kUnbounded;
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points) {
      if (std::isfinite(p.x) && (!log_x || p.x > 0))
        left = std::min(left, p.x * chart.x.unit.scale),
        right = std::max(right, p.x * chart.x.unit.scale);
      if (!p.measured() || (log_y && !(p.y > 0))) continue;
      low = std::min(low, p.y * chart.y.unit.scale),
      high = std::max(high, p.y * chart.y.unit.scale);
    }
  if (chart.floor && chart.floor->y * chart.y.unit.scale > low / 30)  // else far below the picture
    low = std::min(low, chart.floor->y * chart.y.unit.scale);
  const double floor = log_y ? low / 3 : std::min(0.0, low);
  const double top = log_y ? high * 3 : high + 0.12 * (high - floor + (high == floor ? 1 : 0));
  sheet.settings = "set title " + gnuplot_string(title) + "\n" +
                   axis_commands("x", chart.x, log_x) + axis_commands("y", chart.y, log_y) +
                   "set yrange [" + exact(floor) + ":" + exact(top) + "]\n";
  if (!chart.ticks.empty() && chart.ticks.size() <= 12 && log_x) {
    std::string ticks;
    for (const double tick : chart.ticks)
      ticks += (ticks.empty() ? "" : ", ") + gnuplot_string(tick_of(chart.x, tick)) + " " +
               exact(tick * chart.x.unit.scale);
    sheet.settings += "set xtics (" + ticks + ")\n";
  }
  sheet.csv = "curve,solver,label,x,y,status,reason,failed,setting,case\n";
  std::map<std::string, int> variants;
  std::vector<std::string> ends;  // of the points on the upper edge
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points)
      if (failed(p)) push_unique(ends, std::string(to_string(p.record->status.kind)));
  bool failures_named = false, zeros_named = false;
  for (std::size_t i = 0; i < chart.curves.size(); ++i) {
    const Curve& curve = chart.curves[i];
    bool failures = false, zeros = false;
    for (const Point& p : curve.points) {
      const Record& r = *p.record;
      const bool none = failed(p);
      failures = failures || none, zeros = zeros || (!none && p.y == 0);
      sheet.csv += std::to_string(i) + "," + csv_field(curve.solver) + "," +
                   csv_field(curve.label) + "," + exact(p.x) + "," + (none ? "" : exact(p.y)) +
                   "," + std::string(to_string(r.status.kind)) + "," + csv_field(r.status.reason) +
                   "," + (none ? "yes" : "no") + "," + csv_field(work_of(r).text()) + "," +
                   csv_field(r.id) + "\n";
    }
    const std::string scale_x = exact(chart.x.unit.scale), scale_y = exact(chart.y.unit.scale);
    const std::string x = "column(4)*" + scale_x;
    const std::string look = " lc rgb '" + colour_of(curve.solver) + "' dt " +
                             dash_of(curve.solver, variants[curve.solver]++) + " pt " +
                             std::to_string(solver_style(curve.solver).marker);
    const std::string y =
        log_y ? "(column(5) > 0 ? column(5)*" + scale_y + " : NaN)" : "(column(5)*" + scale_y + ")";
    sheet.draw(only(i, false, x.c_str(), y.c_str()) +
               (chart.join ? " with linespoints" : " with points") + look + " title " +
               gnuplot_string(curve.label));
    if (failures)
      sheet.draw(only(i, true, x.c_str(), ("(" + exact(top) + ")").c_str()) +
                 " with points pt 2 ps 1.2 lw 2 lc rgb '" + colour_of(curve.solver) + "' " +
                 (std::exchange(failures_named, true)
                      ? "notitle"
                      : "title " + gnuplot_string("above: " + joined(ends))));
    if (zeros && log_y)
      sheet.draw(
          only(i, false, x.c_str(), ("(column(5) == 0 ? " + exact(floor) + " : NaN)").c_str()) +
          " with points pt 10 ps 1.2 lc rgb '" + colour_of(curve.solver) + "' " +
          (std::exchange(zeros_named, true) ? "notitle" : "title 'below: exactly zero'"));
  }
  if (const double factor = theory_factor(chart); std::isfinite(factor) && left < right)
    sheet.draw("[" + exact(left) + ":" + exact(right) + "] " + exact(factor * chart.y.unit.scale) +
               "*(x/" + exact(chart.x.unit.scale) + ")**" + exact(*chart.slope) +
               " with lines dt (4,4) lc rgb '#5B6472' title 'theory: slope " + exact(*chart.slope) +
               "'");
  if (chart.floor) sheet.draw(floor_line(*chart.floor, chart.y));
  if (chart.front) {
    std::string steps;
    for (const Point& p : pareto_front(chart))
      steps += exact(p.x * chart.x.unit.scale) + " " + exact(p.y * chart.y.unit.scale) + "\n";
    sheet.settings += "$front << EOD\n" + steps + "EOD\n";
    sheet.draw("$front using 1:2 with steps lc rgb '#9BA5B3' title 'Pareto front'");
  }
  return sheet;
}

Sheet series_sheet(std::span<const TimeSeries> all, const std::string& value,
                   const std::string& title) {
  Sheet sheet;
  const Quantity x = quantity("t"), y = quantity(value);
  sheet.settings = "set title " + gnuplot_string(title) + "\n" + axis_commands("x", x, false) +
                   axis_commands("y", y, false);
  sheet.csv = "curve,solver,label,x,y,status,reason,failed,setting,case\n";
  std::map<std::string, int> variants;
  std::size_t i = 0;
  for (const TimeSeries& series : all) {
    if (series.value != value) continue;
    for (std::size_t k = 0; k < series.t.size(); ++k)
      sheet.csv += std::to_string(i) + "," + csv_field(series.solver) + "," +
                   csv_field(series.label) + "," + exact(series.t[k]) + "," + exact(series.y[k]) +
                   ",ok,,no,," + csv_field(series.key) + "\n";
    sheet.draw(only(i++, false, "column(4)", ("(column(5)*" + exact(y.unit.scale) + ")").c_str()) +
               " with lines lw 1.5 lc rgb '" + colour_of(series.solver) + "' dt " +
               dash_of(series.solver, variants[series.solver]++) + " title " +
               gnuplot_string(series.label));
  }
  Chart chart{.id = {}, .scene = {}, .kind = {}, .title = {}, .x = x, .y = y};
  chart.series.assign(all.begin(), all.end());
  add_floor(chart);
  if (chart.floor) sheet.draw(floor_line(*chart.floor, y));
  if (i == 0) throw InputError("no series of '" + value + "' was recorded");
  return sheet;
}

Sheet map_sheet(const std::vector<StatusMap>& maps, const std::string& title) {
  Sheet sheet;
  const StatusMap& first = maps.front();
  sheet.csv = "curve,solver,label,x,y,column,row,status,reason,case\n";
  std::set<Status::Kind> kinds;
  sheet.settings = "set multiplot layout 1," + std::to_string(maps.size()) + " title " +
                   gnuplot_string(title) + "\nset xlabel " + gnuplot_string(first.x.label()) +
                   "\nset ylabel " + gnuplot_string(first.y.label()) + "\n";
  for (const StatusMap& map : maps)
    for (const StatusMap::Cell& cell : map.cells) kinds.insert(cell.record->status.kind);
  std::size_t i = 0;
  for (const StatusMap& map : maps) {
    for (const StatusMap::Cell& cell : map.cells)
      sheet.csv += std::to_string(i) + "," + csv_field(map.solver) + "," + csv_field(map.label) +
                   "," + exact(map.columns[cell.column]) + "," + exact(map.rows[cell.row]) + "," +
                   std::to_string(cell.column) + "," + std::to_string(cell.row) + "," +
                   std::string(to_string(cell.record->status.kind)) + "," +
                   csv_field(cell.record->status.reason) + "," + csv_field(cell.record->id) + "\n";
    const auto ticks = [](const char* axis, const Quantity& q, const std::vector<double>& values) {
      std::string list;
      for (std::size_t k = 0; k < values.size(); ++k)
        list +=
            (k > 0 ? ", " : "") + gnuplot_string(tick_of(q, values[k])) + " " + std::to_string(k);
      return "set " + std::string(axis) + "tics (" + list + ")\nset " + axis +
             "range [-0.5:" + exact(static_cast<double>(values.size()) - 0.5) + "]\n";
    };
    std::string panel;
    for (const Status::Kind kind : kinds) {
      const StatusStyle style = status_style(kind);
      const std::string name(to_string(kind));
      const std::string cells = "'@CSV@' skip 1 using (column(1) == " + std::to_string(i) +
                                " && strcol(8) eq '" + name + "' ? column(6) : NaN):7:";
      panel += (panel.empty() ? "plot " : ", \\\n  ") + cells +
               "(0.45):(0.45) with "
               "boxxyerror fs solid 1 noborder lc rgb '" +
               std::string(style.colour.light) + "' title '" + name + "', \\\n  " + cells + "(" +
               gnuplot_string(style.glyph) + ") with labels tc rgb '" +
               std::string(style.ink.light) + "' notitle";
    }
    sheet.plot += "set title " + gnuplot_string(map.label) + "\n" + ticks("x", map.x, map.columns) +
                  ticks("y", map.y, map.rows) + panel + "\n";
    ++i;
  }
  sheet.plot += "unset multiplot\n";
  return sheet;
}

Sheet profile_sheet(const std::vector<PerformanceProfile>& profiles, const std::string& title) {
  Sheet sheet;
  double most = 2;  // of the finite factors
  for (const PerformanceProfile& profile : profiles)
    for (const double r : profile.ratios)
      if (std::isfinite(r)) most = std::max(most, r);
  sheet.settings = "set title " + gnuplot_string(title) +
                   "\nset xlabel 'CPU time over that of the cheapest solver'\nset logscale x\n"
                   "set ylabel 'share of problems [%]'\nset xrange [1:" +
                   exact(1.1 * most) + "]\nset yrange [0:105]\n";
  sheet.csv = "curve,solver,factor,share\n";
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    const PerformanceProfile& profile = profiles[i];
    std::set<double> factors{1, 1.1 * most};
    for (const double r : profile.ratios)
      if (std::isfinite(r)) factors.insert(r);
    for (const double factor : factors)
      sheet.csv += std::to_string(i) + "," + csv_field(profile.solver) + "," + exact(factor) + "," +
                   exact(profile.share(factor)) + "\n";
    sheet.draw("'@CSV@' skip 1 using (column(1) == " + std::to_string(i) +
               " ? column(3) : NaN):(100*column(4)) with steps lw 2 lc rgb '" +
               colour_of(profile.solver) + "' dt " + dash_of(profile.solver, 0) + " title " +
               gnuplot_string(solver_title(profile.solver)));
  }
  return sheet;
}

/// Whether the key has so many rows that it stands beside the plot, not above it.
bool has_long_key(const Sheet& sheet) {
  constexpr std::size_t kMost = 5;
  std::size_t titles = 0;
  for (auto at = sheet.plot.find(" title "); at != std::string::npos;
       at = sheet.plot.find(" title ", at + 1))
    ++titles;
  return titles > kMost && !sheet.settings.starts_with("set multiplot");
}

std::string script(const PlotSpec& spec, const Sheet& sheet, const std::string& stem) {
  std::string text = "# " + spec.kind + ": " + spec.y + " over " + spec.x +
                     "\n# Again: gnuplot -e \"set terminal svg noenhanced; set output '" + stem +
                     ".svg'\" " + stem +
                     ".gp\n"
                     "set encoding utf8\nset datafile separator ','\nset key " +
                     (has_long_key(sheet) ? "rmargin top left vertical Left reverse"
                                          : "tmargin center horizontal") +
                     "\nset offsets graph 0.04, graph 0.04, 0, 0\nset grid lc rgb "
                     "'#E5E7EB'\nset border 3\nset tics nomirror\n" +
                     sheet.settings + sheet.plot + "\n";
  for (std::size_t at; (at = text.find("@CSV@")) != std::string::npos;)
    text.replace(at, 5, stem + ".csv");
  return text;
}

PlotFiles write_plot(const PlotSpec& spec, const Sheet& sheet,
                     const std::filesystem::path& folder) {
  make_folder(folder);
  const auto path = [&](const char* extension) { return folder / (spec.file + extension); };
  const PlotFiles files{path(".svg"), path(".pdf"), path(".gp"), path(".csv")};
  write_file(files.csv, sheet.csv);
  write_file(files.gp, script(spec, sheet, spec.file));
  const bool wide = has_long_key(sheet);
  run_gnuplot(files.gp,
              "svg noenhanced size " + std::string(wide ? "1000" : "760") +
                  ",520 font 'sans-serif,13' background '#ffffff'",
              files.svg);
  run_gnuplot(files.gp,
              "pdfcairo noenhanced size " + std::string(wide ? "10" : "7.6") +
                  "in,5.2in font 'sans,13' fontscale 0.72",
              files.pdf);
  return files;
}

std::string symptom_text(const ParameterFrontier& one) {
  if (!one.lacks.empty()) return "";
  return std::isnan(one.bad) ? "as far as was asked" : one.symptom;
}

double theory_headroom(const ParameterFrontier& one) {
  return one.downwards ? one.from / one.theory : one.theory / one.from;
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

PlotFiles make_plot(PlotSpec spec, const Records& records, std::span<const TimeSeries> series,
                    const std::filesystem::path& folder) {
  const PlotKind& kind = find_plot_kind(spec.kind);
  if (spec.x.empty()) spec.x = kind.x;
  if (spec.y.empty()) spec.y = kind.y;
  if (spec.along.empty())
    spec.along =
        spec.x == "dt" || spec.x == kSubsteps || spec.x == "vertices" ? spec.x : kind.along;
  for (const std::string& name : {spec.x, spec.y}) check_value_name(name, records);
  if (spec.file.empty()) spec.file = slug(spec.kind + "-" + spec.y + "-over-" + spec.x);
  Sheet sheet;
  if (spec.kind == "series") {
    sheet = series_sheet(series, spec.y, spec.title);
  } else if (spec.kind == "stability") {
    if (records.empty()) throw InputError("there is no case to draw");
    sheet = map_sheet(make_maps(records, records.front()->scene, spec.x, spec.y), spec.title);
  } else {
    Chart chart = make_chart(spec.kind, records, spec.x, spec.y, spec.along);
    add_floor(chart);
    chart.slope = spec.slope, chart.front = spec.kind == "work-precision";
    sheet = curves_sheet(chart, spec.title);
  }
  return write_plot(spec, sheet, folder);
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
  return write_plot(spec, profile_sheet(profiles, spec.title), folder);
}

namespace fs = std::filesystem;

void run_gnuplot(const fs::path& script, const std::string& terminal, const fs::path& out,
                 const std::string& program) try {
  const fs::path temp =
      fs::absolute(out).parent_path() / ("." + out.filename().string() + "." + unique_suffix());
  const EndsWithProgram tie(temp);
  Process process(
      {program, "-e", "set terminal " + terminal + "; set output " + gnuplot_string(temp.string()),
       "./" + script.filename().string()},
      {.errors = ProcessOptions::Stream::piped, .folder = fs::absolute(script).parent_path()});
  const std::string said = process.read_all();
  const int code = process.wait()->exit_code;
  std::error_code missing;
  const auto size = fs::file_size(temp, missing);
  if (code == 0 && !missing && size > 0) {
    fs::rename(temp, out);
    return;
  }
  fs::remove(temp, missing);
  throw PlotError("gnuplot could not draw " + script.string() + ": " +
                  (said.empty() ? "exit code " + std::to_string(code) : said));
} catch (const InputError& error) {
  throw PlotError(std::string(error.what()) +
                  ": install the Debian package gnuplot-nox to get figures");
}

std::filesystem::path plot_frontiers(const std::vector<ParameterFrontier>& all,
                                     const std::filesystem::path& folder, const std::string& stem) {
  std::vector<std::string> parameters, solvers;
  for (const ParameterFrontier& one : all)
    push_unique(parameters, one.parameter), push_unique(solvers, one.solver);
  const double height = 0.8 / static_cast<double>(std::max<std::size_t>(solvers.size(), 1));
  std::string csv = "solver,parameter,y,half,headroom,theory,end\n", ticks;
  double most = 10;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    ticks += (k ? ", " : "") + gnuplot_string(parameters[k]) + " " + std::to_string(k);
  for (const ParameterFrontier& one : all) {
    const auto row = std::ranges::find(parameters, one.parameter) - parameters.begin(),
               place = std::ranges::find(solvers, one.solver) - solvers.begin();
    const double y = static_cast<double>(row) - 0.4 + (static_cast<double>(place) + 0.5) * height;
    const double headroom = std::isnan(one.headroom()) ? 1 : one.headroom();
    const double theory = theory_headroom(one);
    most = std::max({most, headroom, std::isnan(theory) ? 1 : theory});
    csv += std::to_string(place) + "," + csv_field(one.parameter) + "," + exact(y) + "," +
           exact(0.45 * height) + "," + exact(headroom) + "," + exact(theory) + "," +
           csv_field(symptom_text(one)) + "\n";
  }
  std::string script =
      "# How far each parameter goes on the standard scene.\n# Again: gnuplot -e \"set terminal "
      "svg noenhanced; set output '" +
      stem + ".svg'\" " + stem +
      ".gp\nset encoding utf8\nset datafile separator ','\nset key outside top center horizontal\n"
      "set border 3\nset tics nomirror\nset grid x lc rgb '#E5E7EB'\nset logscale x\n"
      "set format x '%g'\nset xlabel 'times harder than where it starts'\nset xrange [1:" +
      exact(most * 300) + "]\nset yrange [" + std::to_string(parameters.size()) + "-0.5:-0.5]\n" +
      "set ytics (" + ticks + ")\n";
  std::string plot;
  for (std::size_t i = 0; i < solvers.size(); ++i) {
    const std::string name = parse_solver(solvers[i]).entry->name.data();
    const std::string rows = "'" + stem + ".csv' skip 1 using (column(1) == " + std::to_string(i);
    // Two settings of one solver share its colour: the second is paler.
    const bool again = i > 0 && parse_solver(solvers[i - 1]).entry->name == name;
    plot += (plot.empty() ? "plot " : ", \\\n  ") + rows +
            " ? 1 : NaN):3:(1):5:($3-$4):($3+$4) with boxxyerror fs solid " +
            (again ? "0.5" : "1") + " noborder lc rgb '" +
            std::string(solver_style(name).colour.light) + "' title " + gnuplot_string(solvers[i]) +
            ", \\\n  " + rows + " ? column(5) : NaN):3:(' '.strcol(7)) with labels left notitle" +
            ", \\\n  " + rows + " ? column(6) : NaN):3 with points pt 2 lc rgb '#111827' " +
            (i == 0 ? "title 'theory'" : "notitle");
  }
  make_folder(folder);
  write_file(folder / (stem + ".csv"), csv);
  write_file(folder / (stem + ".gp"), script + plot + "\n");
  const std::filesystem::path picture = folder / (stem + ".svg");
  run_gnuplot(folder / (stem + ".gp"),
              "svg noenhanced size 900," + std::to_string(140 + 22 * all.size()) +
                  " font 'sans-serif,13' background '#ffffff'",
              picture);
  return picture;
}

}  // namespace taut::report
