#include <algorithm>
#include <cmath>
#include <numeric>

#include "experiments/report/chart.hpp"
#include "experiments/report/format.hpp"
#include "experiments/report/palette.hpp"

namespace taut::report {

namespace {

std::string quoted_neutral(std::string_view name) {
  return "'" + std::string(neutral(name).light) + "'";
}

}  // namespace

std::vector<Point> pareto_front(const std::vector<Curve>& curves) {
  std::vector<Point> all;
  for (const Curve& curve : curves)
    for (const Point& p : curve.points)
      if (p.measured()) all.push_back(p);
  std::ranges::stable_sort(all, {}, [](const Point& p) { return std::pair(p.x, p.y); });
  std::vector<Point> front;
  for (const Point& p : all)
    if (front.empty() || p.y < front.back().y) front.push_back(p);
  return front;
}

std::vector<double> spread_labels(std::vector<double> at, double gap, double low, double high) {
  if (at.size() < 2) return at;
  std::vector<std::size_t> order(at.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return at[i]; });
  gap = std::min(gap, std::max(1.0, (high - low) / static_cast<double>(at.size() - 1)));
  // Equal shares of each overlap, over and over; a handful of labels settles within a few sweeps.
  for (int sweep = 0; sweep < 200; ++sweep)
    for (std::size_t k = 0; k + 1 < order.size(); ++k) {
      double &a = at[order[k]], &b = at[order[k + 1]];
      const double overlap = gap - (b - a);
      if (overlap > 0) a -= overlap / 2, b += overlap / 2;
      a = std::max(a, low + static_cast<double>(k) * gap);
      b = std::min(b, high - static_cast<double>(order.size() - 2 - k) * gap);
    }
  return at;
}

std::string script_preamble(const std::string& title, const PlotArea& area, int width, int height) {
  const auto share = [](double px, int of) { return exact(std::round(px * 1e5 / of) / 1e5); };
  std::string out = "set encoding utf8\nset datafile separator ','\nset key off\n";
  out += "set lmargin at screen " + share(area.left, width) + "\nset rmargin at screen " +
         share(area.right, width) + "\nset tmargin at screen " + share(height - area.top, height) +
         "\nset bmargin at screen " + share(height - area.bottom, height) + "\n";
  out += "set border 3 lw 1 lc rgb " + quoted_neutral("axis") +
         "\nset tics nomirror out scale 0.4,0.2\n";
  if (!title.empty())
    out += "set label " + gnuplot_string(title) + " at screen " + share(area.left, width) +
           ",screen " + share(height - 20, height) + " left tc rgb " + quoted_neutral("ink") +
           " font ',15'\n";
  return out;
}

std::string script_ticks(const std::string& which, const Axis& axis) {
  std::string out = "set " + which + "tics (";
  for (const auto& [at, text] : axis.ticks)
    out += gnuplot_string(text) + " " + exact(at) + (text.empty() ? " 1, " : ", ");
  out.resize(out.size() - (axis.ticks.empty() ? 0 : 2));
  out += ") textcolor rgb " + quoted_neutral("muted") + " font ',12'\nset " + which + "range [" +
         exact(axis.low) + ":" + exact(axis.high) + "]\n";
  if (axis.log) out += "set logscale " + which + "\n";
  return out + "set grid " + which + "tics lw 1 lt 1 lc rgb " + quoted_neutral("grid") + "\n";
}

}  // namespace taut::report
