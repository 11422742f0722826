#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/report/chart/charts.hpp"
#include "experiments/report/chart/frame.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/timing/profile.hpp"

namespace taut::report {

/// A figure for gnuplot: the rows of its CSV, panels on the same axes, and one key for all. "@CSV@"
/// stands for the file's name. Titles and labels enter the script only through gnuplot_string().
struct Sheet {
  struct Panel {
    std::string title, settings, plot;
  };
  std::string csv, settings, x_label, y_label;
  std::vector<Panel> panels;
  /// Entries of the key; a look that several panels have is listed once.
  std::vector<std::string> key, titles;

  /// Draws data into the last panel. A look without a title is left out of the key.
  void draw(const std::string& data, const std::string& look, const std::string& title);
  /// Adds a look to the key.
  void explain(const std::string& look, const std::string& title);
};

/// "lc rgb" of a solver.
std::string colour_of(std::string_view solver);
/// "dt" of a variant of a solver: "(9,4)".
std::string gnuplot_dash(std::string_view solver, int variant);

/// A sheet with a panel for each chart.
Sheet curves_sheet(const Figure&);
/// A sheet with a panel for each scene, which shows its series of this value.
Sheet series_sheet(const std::vector<PlotPanel>&, const std::string& value);
/// A sheet with a panel for each map. Precondition: not empty.
Sheet map_sheet(const std::vector<StatusMap>&);
Sheet profile_sheet(const std::vector<PerformanceProfile>&);

}  // namespace taut::report
