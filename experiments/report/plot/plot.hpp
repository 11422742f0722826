#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "experiments/report/chart/charts.hpp"

namespace taut::report {

/// A kind of plot and what it shows unless asked otherwise.
struct PlotKind {
  std::string_view name;         ///< "error-iterations"
  std::string_view summary;      ///< one sentence
  std::string_view x, y, along;  ///< defaults; `along`: the setting that orders a curve
};
std::span<const PlotKind> plot_kinds();
/// Throws InputError with a suggestion if there is no such kind.
const PlotKind& find_plot_kind(std::string_view name);

/// What to plot; empty parts are the kind's own.
struct PlotSpec {
  std::string kind, x, y, along, title;
  std::string file;             ///< without extension; "": from kind, x and y
  std::optional<double> slope;  ///< the theory's exponent
};

struct PlotFiles {
  std::filesystem::path svg, pdf, gp, csv;
};

/// Draws the records of one scene, or the series over time, with gnuplot: plain axes, a key, error
/// bars, failures on the upper edge. The CSV has one header and a row for each point. Throws
/// InputError if x or y is not known (with a suggestion) or there is nothing to draw, and PlotError
/// without gnuplot (script and CSV are there then).
PlotFiles make_plot(PlotSpec, const Chosen&, std::span<const TimeSeries>,
                    const std::filesystem::path& folder);

/// The share of problems, an error `spec.y` to be reached on a scene, in which each solver costs at
/// most a factor of the best (experiments/timing/profile.hpp). Throws as make_plot().
PlotFiles make_profile_plot(PlotSpec, const BenchSession&, const std::filesystem::path& folder);

/// Throws InputError with a suggestion if no case and no metric has a value of this name.
void check_value_name(const std::string& name, const Chosen&);

}  // namespace taut::report
