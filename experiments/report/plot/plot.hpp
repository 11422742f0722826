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

/// A kind of plot, and what it shows by default.
struct PlotKind {
  enum class Content {
    curves,
    curves_with_front,  ///< curves and their Pareto front
    series,             ///< values over time
    maps,               ///< statuses over two settings, a figure for each scene
    profile             ///< shares of problems, measured by a bench
  };
  /// Exponent of the theory with which curves are compared.
  enum class Slope {
    none,
    one,
    of_scene  ///< that of each scene, over sweeps
  };
  std::string_view name;         ///< "convergence"
  std::string_view x, y, along;  ///< defaults; `along` is the setting that orders a curve
  Content content = Content::curves;
  Slope slope = Slope::none;
};
std::span<const PlotKind> plot_kinds();
/// Throws InputError with a suggestion if there is no such kind.
const PlotKind& find_plot_kind(std::string_view name);

/// Size of a figure on paper; 0: default. With a width, the key is below the panels.
struct FigureSize {
  double width = 0, height = 0;  ///< mm
  double font = 0;               ///< pt
};

/// Font of a figure whose width is given, unless its font is, too [pt].
inline constexpr double kPaperFont = 8;

/// Parses numbers with units: "84mm", "60mm", "8pt"; "" is 0. Throws InputError that names the
/// option.
FigureSize parse_figure_size(const std::string& width, const std::string& height,
                             const std::string& font);

/// What to plot. Empty members stand for the defaults of the kind.
struct PlotSpec {
  std::string kind, x, y, along, title;
  std::string file;    ///< without extension; "": made from kind, x and y
  std::string remark;  ///< written into the script
  FigureSize size = {};
};

/// Contents of one panel: the records of one scene, or its series over time.
struct PlotPanel {
  std::string title;
  Records records;
  std::vector<TimeSeries> series = {};
  std::optional<double> slope = {};  ///< exponent of a theory
};

struct PlotFiles {
  std::filesystem::path svg, pdf, gp, csv;
  std::vector<std::string> without;  ///< panels that cannot be drawn, and why
};

/// Draws panels on the same axes with one key, using gnuplot. Failures are marked on the upper
/// edge. On a logarithmic axis, zeros are on the lower edge; in a figure of several panels, so are
/// values below 1e-8 of the largest. The kind "stability" has a panel for each solver and choice of
/// settings. The CSV has one header and a row for each point. Throws InputError if x or y is
/// unknown (with a suggestion) or there is nothing to draw, and PlotError without gnuplot; script
/// and CSV exist then.
PlotFiles make_plot(PlotSpec, const std::vector<PlotPanel>&, const std::filesystem::path& folder);

/// Draws the share of problems for which each solver costs at most a factor of the best
/// (experiments/timing/profile.hpp). A problem is an error `spec.y` to be reached on a scene.
/// Throws as make_plot() does.
PlotFiles make_profile_plot(PlotSpec, const StudyBench&, const std::filesystem::path& folder);

/// Throws InputError with a suggestion if neither a case nor a metric has a value of this name.
void check_value_name(const std::string& name, const Records&);

/// gnuplot is missing or refused a script. The message says what to do; the caller continues
/// without the figure.
class PlotError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The disk does not accept a figure.
class FigureNotWritten : public InputError {
 public:
  using InputError::InputError;
};

/// Runs `script` in its folder. The picture is written under a temporary name and renamed to `out`
/// only if gnuplot succeeded and completed it. `terminal` is the argument of "set terminal";
/// `program` is searched in PATH. Throws PlotError and FigureNotWritten.
void run_gnuplot(const std::filesystem::path& script, const std::string& terminal,
                 const std::filesystem::path& out, const std::string& program = "gnuplot");

/// Draws a bar for each parameter and solver: its length is the factor by which the parameter can
/// be made harder than its start, its label is the symptom at the end, and a mark shows the end
/// according to theory. Writes `stem`.csv, .gp and .svg into the folder and returns the path of the
/// picture. Throws PlotError without gnuplot, and InputError if the files cannot be written.
std::filesystem::path plot_frontiers(const std::vector<ParameterFrontier>&,
                                     const std::filesystem::path& folder, const std::string& stem);

/// Draws a value over builds, with a line for each of the first 24 cases and a circle at each step.
/// Precondition: there are builds and cases. Writes files and throws as plot_frontiers() does.
std::filesystem::path plot_history(const History&, const std::string& value,
                                   const std::filesystem::path& folder, const std::string& stem);

}  // namespace taut::report
