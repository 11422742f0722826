#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/report/axis.hpp"
#include "experiments/report/curves.hpp"
#include "experiments/report/figures.hpp"

namespace taut::report {

/// Curves over two axes: what every kind but the stability map is made of.
struct Chart {
  std::string title;
  int width = 760, height = 470;  ///< px
  Axis x, y;
  std::vector<Curve> curves;
  std::optional<double> slope;  ///< a dashed line of this exponent below the curves
  std::optional<double> floor;  ///< SI, the reference's own error: nothing below it means anything
  bool stair = false;           ///< the Pareto front behind the curves
  bool name_points = false;     ///< the swept setting beside every other point
  bool markers = true;
  bool lines = true;
};

/// A chart narrower than this has the names of its curves above the plot, not at their ends.
constexpr int kNarrow = 420;  ///< px

/// Script, data, table and plot area. Failures become glyphs in a strip above the plot, in the row
/// of their solver; exact zeros of a logarithmic axis lie on its floor as open triangles.
Drawing draw_chart(Chart);

/// The chart of spec.y over spec.x for these records: sweeps get an axis of their own values, all
/// else fitted logarithmic axes. Throws InputError if no record has both.
Chart curves_chart(const FigureSpec&, std::span<const Record>);

/// The points that no other measured point beats in both x and y, by ascending x.
std::vector<Point> pareto_front(const std::vector<Curve>&);

/// Moves label positions (px, any order) apart to at least `gap`, inside [low, high] as far as they
/// fit; keeps their order and moves them as little as it can.
std::vector<double> spread_labels(std::vector<double> at, double gap, double low, double high);

/// Lines that every script begins with: fonts, border, grid.
std::string script_preamble(const std::string& title, const PlotArea&, int width, int height);

/// "set xtics (...)"; `which` is "x" or "y".
std::string script_ticks(const std::string& which, const Axis&);

}  // namespace taut::report
