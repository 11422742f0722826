#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiments/report/chart/charts.hpp"
#include "experiments/report/chart/frame.hpp"
#include "experiments/report/plot/plot.hpp"
#include "experiments/timing/profile.hpp"

namespace taut::report {

/// A figure for gnuplot: the rows of its CSV, panels on the same axes, one key for all. "@CSV@"
/// stands for the file's name. Titles and labels reach the script by gnuplot_string() alone.
struct Sheet {
  struct Panel {
    std::string title, settings, plot;
  };
  std::string csv, settings, x_label, y_label;
  std::vector<Panel> panels;
  std::vector<std::string> key, titles;  ///< of each look that the panels have: once

  /// Draws data into the last panel. A look without a title is not in the key.
  void draw(const std::string& data, const std::string& look, const std::string& title);
  void explain(const std::string& look, const std::string& title);
};

/// "lc rgb" and "dt" of a solver: "(9,4)".
std::string colour_of(std::string_view solver);
std::string gnuplot_dash(std::string_view solver, int variant);

/// A panel for each chart.
Sheet curves_sheet(const Figure&);
/// A panel for each scene; of its series those of this value.
Sheet series_sheet(const std::vector<PlotPanel>&, const std::string& value);
/// A panel for each map. Precondition: not empty.
Sheet map_sheet(const std::vector<StatusMap>&);
Sheet profile_sheet(const std::vector<PerformanceProfile>&);

}  // namespace taut::report
