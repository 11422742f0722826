#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/history/history.hpp"
#include "experiments/report/chart/charts.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"

namespace taut::report {

/// A kind of plot and what it shows unless asked otherwise.
struct PlotKind {
  std::string_view name;         ///< "convergence"
  std::string_view x, y, along;  ///< defaults; `along`: the setting that orders a curve
};
std::span<const PlotKind> plot_kinds();
/// Throws InputError with a suggestion if there is no such kind.
const PlotKind& find_plot_kind(std::string_view name);

/// How large a figure is on paper; 0: as it comes. With a width the key stands below the panels.
struct FigureSize {
  double width = 0, height = 0;  ///< mm
  double font = 0;               ///< pt
};

/// Of numbers with their unit: "84mm", "60mm", "8pt"; "" is 0. Throws InputError that names the
/// option.
FigureSize parse_figure_size(const std::string& width, const std::string& height,
                             const std::string& font);

/// What to plot; empty parts are the kind's own.
struct PlotSpec {
  std::string kind, x, y, along, title;
  std::string file;    ///< without extension; "": from kind, x and y
  std::string remark;  ///< stands in the script
  FigureSize size = {};
};

/// What stands in one panel of a figure: the records of one scene, or its series over time.
struct PlotPanel {
  std::string title;
  Records records;
  std::vector<TimeSeries> series = {};
  std::optional<double> slope = {};  ///< the theory's exponent
};

struct PlotFiles {
  std::filesystem::path svg, pdf, gp, csv;
  std::vector<std::string> without;  ///< panels in which nothing can be drawn, and why
};

/// Draws panels on the same axes with one key beside them, with gnuplot. Failures stand on the
/// upper edge; on a logarithmic axis zeros stand on the lower one and, in a figure of several
/// panels, so does what is below 1e-8 of the largest value. Kind "stability" has a panel for each
/// solver and choice. The CSV has one header and a row for each point. Throws InputError if x or y
/// is not known (with a suggestion) or there is nothing to draw, and PlotError without gnuplot
/// (script and CSV are there then).
PlotFiles make_plot(PlotSpec, const std::vector<PlotPanel>&, const std::filesystem::path& folder);

/// A problem is an error `spec.y` to be reached on a scene. Draws the share of problems in which
/// each solver costs at most a factor of the best (experiments/timing/profile.hpp). Throws as
/// make_plot().
PlotFiles make_profile_plot(PlotSpec, const StudyBench&, const std::filesystem::path& folder);

/// Throws InputError with a suggestion if no case and no metric has a value of this name.
void check_value_name(const std::string& name, const Records&);

/// gnuplot is missing or refused a script. Says what to do; the caller goes on without the figure.
class PlotError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The disk does not take a figure.
class FigureNotWritten : public InputError {
 public:
  using InputError::InputError;
};

/// Runs `script` with its folder as working directory; the picture goes to `out` by way of a
/// temporary name, and only if gnuplot succeeded and wrote it to its end. `terminal` is the
/// argument of "set terminal"; `program` is looked up in PATH. Throws PlotError, and
/// FigureNotWritten.
void run_gnuplot(const std::filesystem::path& script, const std::string& terminal,
                 const std::filesystem::path& out, const std::string& program = "gnuplot");

/// A bar for each parameter and solver, as long as it may be made harder than where it starts,
/// with what goes wrong at its end; a mark where theory has the end. Writes `stem`.csv, .gp and
/// .svg into the folder and gives the picture's path. Throws PlotError without gnuplot and
/// InputError if the files cannot be written.
std::filesystem::path plot_frontiers(const std::vector<ParameterFrontier>&,
                                     const std::filesystem::path& folder, const std::string& stem);

/// A value over builds, a line for each of the first 24 cases, a circle where it stepped.
/// Precondition: there are builds and cases. Writes and throws as plot_frontiers().
std::filesystem::path plot_history(const History&, const std::string& value,
                                   const std::filesystem::path& folder, const std::string& stem);

}  // namespace taut::report
