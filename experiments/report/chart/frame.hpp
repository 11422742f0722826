#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "experiments/report/chart/charts.hpp"

namespace taut::report {

/// An axis and its ends, slightly beyond what it shows, in displayed units.
struct Scale {
  bool logarithmic = false;
  double low = 0, high = 1;
};
/// Scale for these values. A logarithmic one ignores values that are not positive.
Scale scale_of(bool logarithmic, const std::vector<double>& values);

/// The axes that all panels of a figure share. They determine what gnuplot and the page draw.
struct Frame {
  Scale x, y;
  /// For a logarithmic y, in displayed units: smaller values and zero are put on the axis.
  double least = 0;
};
/// Precondition: not empty, all with the same quantities.
Frame frame_of(std::span<const Chart>, bool logarithmic_y);
/// Whether y is logarithmic: the quantity is shown that way and has a positive value.
bool is_logarithmic(std::span<const Chart>);
/// Whether any y is positive, so that its axis can be logarithmic.
bool any_positive(std::span<const Chart>);

/// Whether the point is on the axis because it is zero or too small for a logarithmic one.
bool on_axis(const Point&, const Unit& y, const Frame&);

/// Numbers the labels of each solver in the order of the calls. Each number has its own dash, the
/// same in all panels of a figure.
class Variants {
 public:
  int of(const std::string& solver, const std::string& label);

 private:
  std::map<std::string, std::vector<std::string>> labels_;
};

/// Charts of the same quantities, which are panels on the same axes.
struct Figure {
  std::string title;
  std::vector<Chart> charts;
};
/// Makes a figure: numbers the variants of curves over all panels, and removes floors far below all
/// points. Precondition: not empty, all with the same quantities.
Figure figure_of(std::vector<Chart>);
/// A figure for each pair of quantities, grouped by y and then x, in the order of the charts.
std::vector<Figure> figures_of(const std::vector<Chart>&);

}  // namespace taut::report
