#include "experiments/report/chart/frame.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "experiments/system/distinct.hpp"

namespace taut::report {

namespace {

/// Margin of an axis beyond either end, as a share of its range.
constexpr double kAir = 0.06;
/// Least margin of a logarithmic axis, as a factor.
constexpr double kLeastFactor = 1.12;
/// Largest ratio that a logarithmic axis shows.
constexpr double kDecades = 1e8;
/// A floor is not drawn if it is below the smallest point by this factor.
constexpr double kFarBelow = 30;

void for_each_point(std::span<const Chart> charts, const std::function<void(const Point&)>& see) {
  for (const Chart& chart : charts)
    for (const Curve& curve : chart.curves)
      for (const Point& p : curve.points) see(p);
}

/// Values of x in SI units, including the ends of cost intervals.
std::vector<double> all_x(std::span<const Chart> charts) {
  std::vector<double> values;
  for_each_point(charts, [&](const Point& p) { values.push_back(p.x); });
  for (const Chart& chart : charts)
    for (const auto& [key, interval] : chart.cost) {
      values.push_back(interval.low);
      values.push_back(interval.high);
    }
  return values;
}

/// Values of y in SI units, including floors.
std::vector<double> all_y(std::span<const Chart> charts) {
  std::vector<double> values;
  for_each_point(charts, [&](const Point& p) {
    if (p.measured()) values.push_back(p.y);
  });
  for (const Chart& chart : charts)
    if (chart.floor) values.push_back(chart.floor->y);
  return values;
}

std::vector<double> scaled(std::vector<double> values, double scale) {
  for (double& v : values) v *= scale;
  return values;
}

bool positive(double v) { return std::isfinite(v) && v > 0; }

void drop_low_floor(Chart& chart) {
  double least = std::numeric_limits<double>::infinity();
  for_each_point({&chart, 1}, [&](const Point& p) {
    if (p.measured() && p.y > 0) least = std::min(least, p.y);
  });
  if (chart.floor && chart.floor->y <= least / kFarBelow) chart.floor.reset();
}

}  // namespace

Scale scale_of(bool logarithmic, const std::vector<double>& values) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double v : values)
    if (logarithmic ? positive(v) : std::isfinite(v)) {
      low = std::min(low, v);
      high = std::max(high, v);
    }
  if (!(low <= high)) return logarithmic ? Scale{true, 0.1, 1} : Scale{};
  if (logarithmic) {
    const double air = std::max(std::pow(high / low, kAir), kLeastFactor);
    return {true, low / air, high * air};
  }
  if (low >= 0 && low < 0.5 * high) low = 0;
  if (low == 0 && high == 0) high = 1;
  const double range = high > low ? high - low : std::abs(high);
  return {false, low == 0 ? 0 : low - kAir * range, high + kAir * range};
}

Frame frame_of(std::span<const Chart> charts, bool logarithmic_y) {
  const Unit &x = charts.front().x.unit, &y = charts.front().y.unit;
  const std::vector<double> across = scaled(all_x(charts), x.scale);
  std::vector<double> up = scaled(all_y(charts), y.scale);
  Frame frame;
  frame.x = scale_of(x.logarithmic && std::ranges::any_of(across, positive), across);
  if (logarithmic_y) {
    double highest = 0;
    for (const double v : up) highest = std::fmax(highest, v);
    frame.least = highest / kDecades;
    std::erase_if(up, [&](double v) { return v < frame.least; });
  }
  frame.y = scale_of(logarithmic_y, up);
  return frame;
}

bool any_positive(std::span<const Chart> charts) {
  bool any = false;
  for_each_point(charts, [&](const Point& p) { any = any || (p.measured() && p.y > 0); });
  return any;
}

bool is_logarithmic(std::span<const Chart> charts) {
  return charts.front().y.unit.logarithmic && any_positive(charts);
}

bool on_axis(const Point& p, const Unit& y, const Frame& frame) {
  return frame.y.logarithmic && p.measured() && p.y >= 0 &&
         (p.y == 0 || p.y * y.scale < frame.least);
}

int Variants::of(const std::string& solver, const std::string& label) {
  std::vector<std::string>& own = labels_[solver];
  push_unique(own, label);
  return static_cast<int>(std::ranges::find(own, label) - own.begin());
}

Figure figure_of(std::vector<Chart> charts) {
  Figure figure{charts.front().title, std::move(charts)};
  Variants variants;
  for (Chart& chart : figure.charts) {
    for (Curve& curve : chart.curves) curve.variant = variants.of(curve.solver, curve.label);
    drop_low_floor(chart);
  }
  return figure;
}

std::vector<Figure> figures_of(const std::vector<Chart>& charts) {
  std::vector<std::pair<std::string, std::vector<Chart>>> by_y;
  for (const Chart& chart : charts) group_of(by_y, chart.y.name).push_back(chart);
  std::vector<Figure> figures;
  for (const auto& [y, of_y] : by_y) {
    std::vector<std::pair<std::string, std::vector<Chart>>> by_x;
    for (const Chart& chart : of_y) group_of(by_x, chart.x.name).push_back(chart);
    for (auto& [x, of_both] : by_x) figures.push_back(figure_of(std::move(of_both)));
  }
  return figures;
}

}  // namespace taut::report
