#include "experiments/report/plot/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/plot/sheet.hpp"
#include "experiments/system/files.hpp"

namespace taut::report {

std::string colour_of(std::string_view solver) {
  return std::string(solver_style(solver).colour.light);
}

std::string gnuplot_dash(std::string_view solver, int variant) {
  std::string dash(dash_of(solver, variant));
  if (dash.empty()) return "solid";
  std::ranges::replace(dash, ' ', ',');
  return "(" + dash + ")";
}

void Sheet::draw(const std::string& data, const std::string& look, const std::string& title) {
  std::string& plot = panels.back().plot;
  plot += (plot.empty() ? "plot " : ", \\\n  ") + data + " " + look + " notitle";
  explain(look, title);
}

void Sheet::explain(const std::string& look, const std::string& title) {
  const std::string entry = look + " title " + gnuplot_string(title);
  if (title.empty() || std::ranges::find(key, entry) != key.end()) return;
  key.push_back(entry);
  titles.push_back(title);
}

namespace {

/// Name of the first value with this role.
std::string_view value_with(Role role) {
  const std::vector<const ValueSpec*> all = values_with_role();
  const auto at = std::ranges::find(all, role, &ValueSpec::role);
  return at == all.end() ? "" : (*at)->name;
}

/// Width of a letter and height of a line in the key, at a font of 13 [px].
constexpr double kLetter = 9, kLine = 21;
/// Width of a letter by which gnuplot spaces the columns of a key [px].
constexpr double kGnuplotsLetter = 11;
/// Length of the line sample before an entry of the key [px].
constexpr double kSample = 75;
/// Room for ticks and titles of the axes [px].
constexpr double kLeft = 116, kBottom = 62;
/// Least width of a panel in a figure of given width [px].
constexpr double kNarrowest = 190;
/// Points per millimetre.
constexpr double kPoints = 72.0 / 25.4;
/// Font size [px], and size of a pixel in the PDF [pt].
constexpr double kFont = 13, kPixel = 0.72;

/// Layout of a figure's panels and key, in pixels at a font of 13. If a width is given, it
/// determines how many panels are side by side, and the key is below them.
struct Layout {
  std::size_t panels, columns, rows, key_columns = 1, key_rows;
  double pixel = kPixel;  ///< pt per pixel
  double width, height, entry = 0, header;
  bool below;

  Layout(const Sheet& sheet, const FigureSize& size, bool title)
      : panels(sheet.panels.size()),
        columns(panels < 2    ? 1
                : panels < 5  ? 2
                : panels < 10 ? 3
                              : 4),
        below(size.width > 0) {
    double letters = 0;
    for (const std::string& text : sheet.titles)
      letters = std::max(letters, static_cast<double>(std::ranges::count_if(
                                      text, [](char c) { return (c & 0xC0) != 0x80; })));
    entry = kSample + kLetter * letters;
    if (size.font > 0 || below) pixel = (size.font > 0 ? size.font : kPaperFont) / kFont;
    const auto at_least_one = [](double n) { return std::max<std::size_t>(1, std::size_t(n)); };
    if (below) {
      width = size.width * kPoints / pixel;
      columns = std::min(columns, at_least_one((width - kLeft) / kNarrowest));
      key_columns = 1 + static_cast<std::size_t>(
                            std::max(0.0, (width - entry) / (kSample + kGnuplotsLetter * letters)));
    } else {
      width = (panels > 1 ? 310 * static_cast<double>(columns) : 680) + 40 + entry;
    }
    rows = (panels + columns - 1) / columns;
    key_rows = (sheet.titles.size() + key_columns - 1) / key_columns;
    header = (title ? 34 : 10) + (panels > 1 ? 34 : 6);
    const double across = (width - kLeft) / static_cast<double>(columns),
                 panel = below        ? std::max(150.0, 0.66 * across)
                         : panels > 1 ? 250
                                      : 440;
    height = static_cast<double>(rows) * panel + header + kBottom + foot();
    if (!below) height = std::max(height, header + key());
    if (size.height > 0) height = size.height * kPoints / pixel;
    if (size.height > 0 && height < header + kBottom + foot() + 80 * static_cast<double>(rows))
      throw InputError(
          "--height " + significant(size.height) + "mm: its panels and its key need " +
          significant(
              (header + kBottom + foot() + 80 * static_cast<double>(rows)) * pixel / kPoints, 3) +
          "mm");
    if (below && entry > width)
      throw InputError("--width " + significant(size.width) + "mm: the key alone needs " +
                       significant(entry * pixel / kPoints, 3) + "mm at this font");
  }
  double key() const { return kLine * static_cast<double>(key_rows) + 12; }
  double foot() const { return below ? key() : 0; }
  double right() const { return 1 - (below ? 14 : entry + 10) / width; }
  double left() const { return kLeft / width; }
  double top() const { return 1 - header / height; }
  double bottom() const { return (kBottom + foot()) / height; }
};

/// Commands for a panel. Of several panels, only those at the figure's edge have axis titles.
std::string panel_commands(const Sheet& sheet, const Layout& layout, std::size_t at) {
  const Sheet::Panel& panel = sheet.panels[at];
  const bool first = at % layout.columns == 0, last = at + layout.columns >= layout.panels;
  return "set title " + gnuplot_string(layout.panels > 1 ? panel.title : "") + "\nset xlabel " +
         gnuplot_string(last ? sheet.x_label : "") + "\nset ylabel " +
         gnuplot_string(first ? sheet.y_label : "") + "\n" + panel.settings + panel.plot + "\n";
}

/// Place of the key: a column beside the panels, or rows below them.
std::string key_place(const Layout& layout) {
  if (!layout.below)
    return "set origin " + exact(layout.right()) + ", 0\nset key at screen " +
           exact(layout.right()) + ", screen " + exact(layout.top()) + " left top Left reverse\n";
  return "set key at screen 0.01, screen " + exact((layout.key() - 4) / layout.height) +
         " left top Left reverse vertical maxrows " + std::to_string(layout.key_rows) +
         " samplen 3 width 1\n";
}

std::string script(const PlotSpec& spec, const Sheet& sheet, const Layout& layout) {
  const auto pixels = [](double n) { return std::to_string(std::lround(n)); };
  std::string text =
      "# " + spec.kind + ": " + spec.y + " over " + spec.x +
      (spec.remark.empty() ? "" : "\n# " + spec.remark) +
      "\n# Again: gnuplot -e \"set terminal svg noenhanced size " + pixels(layout.width) + "," +
      pixels(layout.height) + "; set output '" + spec.file + ".svg'\" " + spec.file +
      ".gp\nset encoding utf8\nset datafile separator ','\nunset key\n"
      "set grid lc rgb '#E5E7EB'\nset border 3\nset tics nomirror\n" +
      sheet.settings + "set multiplot layout " + std::to_string(layout.rows) + "," +
      std::to_string(layout.columns) +
      (spec.title.empty() ? "" : " title " + gnuplot_string(spec.title)) + " margins screen " +
      exact(layout.left()) + ", screen " + exact(layout.right()) + ", screen " +
      exact(layout.bottom()) + ", screen " + exact(layout.top()) + " spacing char 7, char 4\n";
  for (std::size_t i = 0; i < sheet.panels.size(); ++i) text += panel_commands(sheet, layout, i);
  text += "# The key of all panels.\nreset\nset border 0\nunset tics\nset margins 0, 0, 0, 0\n" +
          key_place(layout) + "plot [0:1][0:1] NaN notitle";
  for (const std::string& entry : sheet.key) text += ", \\\n  keyentry " + entry;
  text += "\nunset multiplot\n";
  for (std::size_t at; (at = text.find("@CSV@")) != std::string::npos;)
    text.replace(at, 5, spec.file + ".csv");
  return text;
}

PlotFiles write_plot(const PlotSpec& spec, const Sheet& sheet,
                     const std::filesystem::path& folder) try {
  make_folder(folder);
  const auto path = [&](const char* extension) { return folder / (spec.file + extension); };
  PlotFiles files{path(".svg"), path(".pdf"), path(".gp"), path(".csv"), {}};
  const Layout layout(sheet, spec.size, !spec.title.empty());
  write_file(files.csv, sheet.csv);
  write_file(files.gp, script(spec, sheet, layout));
  const auto size = [&](double scale, const char* unit) {
    return exact(layout.width * scale) + unit + "," + exact(layout.height * scale) + unit;
  };
  run_gnuplot(files.gp,
              "svg noenhanced size " + size(1, "") + " font 'sans-serif,13' background '#ffffff'",
              files.svg);
  run_gnuplot(files.gp,
              "pdfcairo noenhanced size " + size(layout.pixel / 72, "in") +
                  " font 'sans,13' fontscale " + exact(layout.pixel) +
                  (layout.below ? " linewidth 0.8 pointscale 0.7 dashlength 0.8" : ""),
              files.pdf);
  return files;
} catch (const InputError& error) {
  throw FigureNotWritten(error.diagnostics());
}

}  // namespace

std::span<const PlotKind> plot_kinds() {
  using enum PlotKind::Content;
  using enum PlotKind::Slope;
  static const std::array kKinds{
      PlotKind{"contact", kSweeps, value_with(Role::vertex_depth), kSweeps},
      PlotKind{"convergence", kSweeps, kErrorMetric, kSweeps, curves, of_scene},
      PlotKind{"profile", kCpuPerSecond, kErrorMetric, "setting", profile},  // Dolan and More
      PlotKind{"scaling", "vertices", kCpuPerStep, "vertices", curves, one},
      PlotKind{"series", "t", kErrorMetric, "t", series},
      PlotKind{"stability", "dt", kSweeps, "dt", maps},
      PlotKind{"work-precision", "projections", kErrorMetric, "setting", curves_with_front},
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

namespace {

/// A number with its unit; 0 if the text is empty.
double size_of(const char* option, const std::string& text, const std::string& unit) {
  if (text.empty()) return 0;
  const auto value = text.ends_with(unit) ? whole<double>(text.substr(0, text.size() - unit.size()))
                                          : std::nullopt;
  if (!value || !(*value > 0 && *value <= 2000))
    throw InputError(std::string(option) + " " + text + ": expected a number with its unit, as 8" +
                     unit);
  return *value;
}

}  // namespace

FigureSize parse_figure_size(const std::string& width, const std::string& height,
                             const std::string& font) {
  return {size_of("--width", width, "mm"), size_of("--height", height, "mm"),
          size_of("--font", font, "pt")};
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

/// The sheet of everything that can be drawn. Adds to `without` why other panels cannot. Throws
/// InputError if none can.
Sheet sheet_of(const PlotSpec& spec, const PlotKind& kind, const std::vector<PlotPanel>& panels,
               std::vector<std::string>& without) {
  using Content = PlotKind::Content;
  std::vector<Chart> charts;
  std::vector<StatusMap> maps;
  std::vector<PlotPanel> series;
  for (const PlotPanel& panel : panels) try {
      if (kind.content == Content::series) {
        if (std::ranges::find(panel.series, spec.y, &TimeSeries::value) == panel.series.end())
          throw InputError("no series of '" + spec.y + "' was recorded");
        series.push_back(panel);
      } else if (kind.content == Content::maps) {
        if (panel.records.empty()) throw InputError("there is no case to draw");
        std::ranges::move(make_maps(panel.records, panel.records.front()->scene, spec.x, spec.y),
                          std::back_inserter(maps));
      } else {
        Chart chart = make_chart(spec.kind, panel.records, spec.x, spec.y, spec.along);
        add_floor(chart);
        chart.title = panel.title;
        chart.slope = panel.slope;
        chart.front = kind.content == Content::curves_with_front;
        charts.push_back(std::move(chart));
      }
    } catch (const InputError& error) {
      without.push_back(panel.title + (panel.title.empty() ? "" : ": ") + error.what());
    }
  if (series.empty() && maps.empty() && charts.empty())
    throw InputError(without.empty() ? "there is nothing to draw" : without.front());
  return !series.empty() ? series_sheet(series, spec.y)
         : !maps.empty() ? map_sheet(maps)
                         : curves_sheet(figure_of(charts));
}

}  // namespace

PlotFiles make_plot(PlotSpec spec, const std::vector<PlotPanel>& panels,
                    const std::filesystem::path& folder) {
  const PlotKind& kind = find_plot_kind(spec.kind);
  if (spec.x.empty()) spec.x = kind.x;
  if (spec.y.empty()) spec.y = kind.y;
  Records all;
  for (const PlotPanel& panel : panels)
    all.insert(all.end(), panel.records.begin(), panel.records.end());
  // Curves run along a setting, not along a measured value.
  const bool measured = spec.x == "projections" || std::ranges::any_of(all, [&](const Record* r) {
                          return r->values.contains(spec.x);
                        });
  if (spec.along.empty()) spec.along = measured ? kind.along : spec.x;
  for (const std::string& name : {spec.x, spec.y}) check_value_name(name, all);
  if (spec.file.empty()) spec.file = slug(spec.kind + "-" + spec.y + "-over-" + spec.x);
  std::vector<std::string> without;
  const Sheet sheet = sheet_of(spec, kind, panels, without);
  PlotFiles files = write_plot(spec, sheet, folder);
  files.without = std::move(without);
  return files;
}

PlotFiles make_profile_plot(PlotSpec spec, const StudyBench& bench,
                            const std::filesystem::path& folder) {
  const PlotKind& kind = find_plot_kind("profile");
  spec.x = kind.x;
  if (spec.y.empty() && std::ranges::any_of(bench.scenes, [](const SceneBench& scene) {
        return scene.deciding_metric() == kVerdict;
      }))
    spec.y = kVerdict;
  if (spec.y.empty()) spec.y = kind.y;
  if (spec.file.empty()) spec.file = slug("profile-" + spec.y);
  const std::vector<PerformanceProfile> profiles =
      performance_profiles(bench.scenes, spec.y, levels_of(spec.y));
  if (profiles.empty() || profiles.front().ratios.empty())
    throw InputError("no setting of any solver reaches an error of " + spec.y +
                     " that is asked for");
  return write_plot(spec, profile_sheet(profiles), folder);
}

}  // namespace taut::report
