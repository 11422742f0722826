#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "experiments/report/chart/charts.hpp"

namespace taut::report {

/// An axis with its ends, a little beyond what it shows; in shown units.
struct Scale {
  bool logarithmic = false;
  double low = 0, high = 1;
};
/// Of these values; a logarithmic one leaves out what is not positive.
Scale scale_of(bool logarithmic, const std::vector<double>& values);

/// The axes that all panels of a figure share. What gnuplot and the page draw is decided here.
struct Frame {
  Scale x, y;
  double least = 0;  ///< in shown units, of a logarithmic y: less, and zero, stands on the axis
};
/// Precondition: not empty, all of the same quantities.
Frame frame_of(std::span<const Chart>, bool logarithmic_y);
/// The scale of y that fits: logarithmic if the quantity is shown so and has a positive value.
bool is_logarithmic(std::span<const Chart>);
/// Whether any y is positive: then it can have a logarithmic axis.
bool any_positive(std::span<const Chart>);

/// Whether the point stands on the axis: it is zero or too small for a logarithmic one.
bool on_axis(const Point&, const Unit& y, const Frame&);

/// Numbers the labels of each solver in the order in which they are asked for: another dash for
/// each, the same in all panels of a figure.
class Variants {
 public:
  int of(const std::string& solver, const std::string& label);

 private:
  std::map<std::string, std::vector<std::string>> labels_;
};

/// Charts of the same quantities, a panel for each on the same axes.
struct Figure {
  std::string title;
  std::vector<Chart> charts;
};
/// With the variants of its curves counted over all panels, and without floors far below all
/// points. Precondition: not empty, all of the same quantities.
Figure figure_of(std::vector<Chart>);
/// A figure for each pair of quantities, y before x, in the order of the charts.
std::vector<Figure> figures_of(const std::vector<Chart>&);

}  // namespace taut::report
