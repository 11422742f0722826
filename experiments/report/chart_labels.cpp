#include "experiments/report/chart_labels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "experiments/report/format.hpp"
#include "experiments/report/palette.hpp"

namespace taut::report {

namespace {

constexpr double kLabelGap = 16;   ///< px between the labels at the ends of curves
constexpr double kStripRow = 15;   ///< px for each curve with failures
constexpr double kKeyRow = 17;     ///< px for names above the plot
constexpr double kKeyMarker = 16;  ///< px before a name
constexpr double kMarker = 8;      ///< px, the largest marker

std::string_view paint(std::string_view name) { return neutral(name).light; }
std::string_view paint(const Curve& curve) {
  return solver_style(curve.solver, curve.variant).colour.light;
}

/// The curves with failures, in rows above the plot: one each, or one a solver where that would
/// leave the plot too little.
std::vector<std::vector<const Curve*>> failing_rows(const Chart& chart) {
  std::vector<std::vector<const Curve*>> each, merged;
  for (const Curve& curve : chart.curves) {
    if (std::ranges::none_of(curve.points, failed)) continue;
    each.push_back({&curve});
    const auto same = [&](const auto& row) { return row.front()->solver == curve.solver; };
    const auto found = std::ranges::find_if(merged, same);
    if (found == merged.end())
      merged.push_back({&curve});
    else
      found->push_back(&curve);
  }
  return static_cast<double>(each.size()) * kStripRow > chart.height * 0.2 ? merged : each;
}

double widest_name(const Chart& chart) {
  double widest = 0;
  for (const Curve& curve : chart.curves) widest = std::max(widest, text_width(curve.label));
  return widest;
}

bool named_above(const Chart& chart) {
  return chart.width < kNarrow || !chart.lines || widest_name(chart) + 22 > chart.width * 0.42 ||
         static_cast<double>(chart.curves.size()) * kLabelGap > chart.height - 90;
}

/// As much of a text as `room` px hold.
std::string cut_to(const std::string& text, double room) {
  if (text_width(text) <= room) return text;
  std::string out = text;
  while (!out.empty() && text_width(out + "…") > room) {
    while (!out.empty() && (static_cast<unsigned char>(out.back()) & 0xC0U) == 0x80U)
      out.pop_back();
    if (!out.empty()) out.pop_back();
  }
  return out + "…";
}

/// The names above a plot, each from its column [px] on in its row: as many a row as fit, and no
/// more rows than leave the plot its room.
struct Name {
  std::string text;
  double x;
  int row;
};
std::vector<Name> names_above(const Chart& chart) {
  std::vector<Name> names;
  const int rows = std::max(1, static_cast<int>(chart.height * 0.3 / kKeyRow));
  double x = 0;
  int row = 0;
  for (const Curve& curve : chart.curves) {
    const std::string text = cut_to(curve.label, chart.width - kKeyMarker - 8);
    const double width = kKeyMarker + text_width(text);
    if (x > 0 && x + width > chart.width - 8) x = 0, ++row;
    if (row == rows) {
      const std::size_t left = chart.curves.size() - names.size() + 1;
      names.back().text = cut_to("… " + std::to_string(left) + " more",
                                 chart.width - names.back().x - kKeyMarker - 8);
      break;
    }
    names.push_back({text, x, row});
    x += width + 14;
  }
  return names;
}

std::string screen(double x, double y, const Chart& chart) {
  return "screen " + exact(std::round(x * 1e5 / chart.width) / 1e5) + "," +
         exact(std::round((chart.height - y) * 1e5 / chart.height) / 1e5);
}

std::pair<double, double> pixel_of_point(const Chart& chart, const PlotArea& area, const Point& p) {
  return pixel_of(chart, area, p.x * chart.x.quantity.scale, p.y * chart.y.quantity.scale);
}

/// What the data cover: markers, curves, the stair.
void reserve_data(Labels& labels, const Chart& chart, const PlotArea& area) {
  const auto join = [&](const std::vector<Point>& points, bool stair) {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      if (!points[i].measured() || !points[i + 1].measured()) continue;
      const auto [x0, y0] = pixel_of_point(chart, area, points[i]);
      const auto [x1, y1] = pixel_of_point(chart, area, points[i + 1]);
      labels.line(x0, y0, x1, stair ? y0 : y1);
      if (stair) labels.line(x1, y0, x1, y1);
    }
  };
  for (const Curve& curve : chart.curves) {
    if (chart.lines) join(curve.points, false);
    if (!chart.markers) continue;
    for (const Point& p : curve.points)
      if (p.measured()) {
        const auto [x, y] = pixel_of_point(chart, area, p);
        labels.mark({x, y, kMarker, kMarker});
      }
  }
  if (chart.stair) join(pareto_front(chart.curves), true);
}

/// Placed by hand: gnuplot would put the title of y where long tick labels push it out of the
/// picture.
void put_titles(Labels& labels, const Chart& chart, const PlotArea& area) {
  if (!chart.title.empty())  // script_preamble draws it
    labels.reserve({chart.title, area.left, 20, Anchor::left, paint("ink"), 15});
  labels.put({chart.x.quantity.label(), (area.left + area.right) / 2, area.bottom + 40,
              Anchor::center, paint("muted")});
  labels.put({chart.y.quantity.label(), 14, (area.top + area.bottom) / 2, Anchor::center,
              paint("muted"), 12, std::numbers::pi / 2});
}

/// Takes the places of tick labels; one that would run into its neighbour's is dropped. From the
/// right and from the bottom: the largest value of a sweep and the lowest error keep theirs.
void reserve_ticks(Labels& labels, Chart& chart, const PlotArea& area) {
  for (auto tick = chart.x.ticks.rbegin(); tick != chart.x.ticks.rend(); ++tick) {
    if (tick->second.empty()) continue;
    const double x = area.left + chart.x.position(tick->first) * (area.right - area.left);
    const Label label{tick->second, x, area.bottom + 18, Anchor::center, paint("muted")};
    Label airy = label;
    airy.text += " ";  // words need a space between them
    if (labels.fits(airy))
      labels.reserve(label);
    else
      tick->second.clear();
  }
  for (auto& [at, text] : chart.y.ticks) {
    if (text.empty()) continue;
    const double y = area.bottom - chart.y.position(at) * (area.bottom - area.top);
    const Label label{text, area.left - 9, y, Anchor::right, paint("muted")};
    if (labels.fits(label))
      labels.reserve(label);
    else
      text.clear();
  }
}

/// The last measured point of a curve, in px from the top.
double end_height(const Chart& chart, const PlotArea& area, const Curve& curve) {
  double y = (area.top + area.bottom) / 2;
  for (const Point& p : curve.points)
    if (p.measured()) y = pixel_of_point(chart, area, p).second;
  return y;
}

/// A piece of the curve before each name above the plot: its marker, its dashes, or both.
std::string sample(const Chart& chart, const Curve& curve, double x, double y) {
  const SolverStyle style = solver_style(curve.solver, curve.variant);
  const std::string colour = " lc rgb '" + std::string(style.colour.light) + "'";
  if (chart.markers)
    return "set label '' at " + screen(x + 6, y, chart) + " point pt " +
           std::to_string(style.marker) + " ps " + exact(0.55 * style.marker_size) + colour + "\n";
  return "set arrow from " + screen(x, y, chart) + " to " + screen(x + 12, y, chart) +
         " nohead lw 2.2" + (style.dash.empty() ? "" : " dt " + std::string(style.dash)) + colour +
         "\n";
}

std::string put_names(Labels& labels, const Chart& chart, const PlotArea& area) {
  std::string commands;
  if (named_above(chart)) {
    const std::vector<Name> names = names_above(chart);
    // Above a broad plot they begin where it does.
    const double shift = std::min(
        chart.width < kNarrow ? 0 : area.left,
        chart.width - 8 -
            std::ranges::max(names, {}, [](const Name& n) { return n.x + text_width(n.text); }).x -
            kKeyMarker);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const double x = names[i].x + std::max(0.0, shift);
      const double y = (chart.title.empty() ? 10 : 44) + kKeyRow * names[i].row;
      const bool more = i + 1 == names.size() && names.size() < chart.curves.size();
      labels.put({names[i].text, x + kKeyMarker, y, Anchor::left,
                  more ? paint("muted") : paint(chart.curves[i])});
      if (more) break;
      commands += sample(chart, chart.curves[i], x, y);
      labels.mark({x + 6, y, 12, kMarker});
    }
    return commands;
  }
  std::vector<double> at;
  for (const Curve& curve : chart.curves) at.push_back(end_height(chart, area, curve));
  at = spread_labels(at, kLabelGap, area.top + 4, area.bottom - 4);
  for (std::size_t i = 0; i < at.size(); ++i)
    labels.put(
        {chart.curves[i].label, area.right + 10, at[i], Anchor::left, paint(chart.curves[i])});
  return commands;
}

/// Glyphs of one row, by kind and place [px].
using Glyphs = std::vector<std::pair<double, Status::Kind>>;

/// Those that would lie on each other become one with their number: "3×".
void put_glyphs(Labels& labels, Glyphs glyphs, double y, std::string_view colour) {
  std::ranges::sort(glyphs);
  std::vector<Label> row;
  for (std::size_t i = 0, next = 0; i < glyphs.size(); i = next) {
    Label label{"", 0, y, Anchor::center, colour, 13};
    double right = glyphs[i].first;
    std::map<Status::Kind, int> counts;
    for (next = i; next < glyphs.size() && glyphs[next].first - right < 30; ++next) {
      // Alone a glyph needs less room than with a number.
      if (next > i && glyphs[next].first - right >= 13 && counts.size() == 1 &&
          counts.begin()->second == 1)
        break;
      right = glyphs[next].first;
      ++counts[glyphs[next].second];
    }
    for (const auto& [kind, n] : counts)
      label.text += (n > 1 ? std::to_string(n) : "") + std::string(status_style(kind).glyph);
    label.x = (glyphs[i].first + right) / 2;
    labels.put(label);
  }
}

/// Rows of glyphs above the plot, in the colours of their curves.
void put_failures(Labels& labels, const Chart& chart, const PlotArea& area) {
  const auto rows = failing_rows(chart);
  double y = area.top - static_cast<double>(rows.size()) * kStripRow + kStripRow / 2 - 3;
  for (const std::vector<const Curve*>& row : rows) {
    const std::string_view colour = paint(*row.front());
    Glyphs glyphs;
    bool refused = true;
    for (const Curve* curve : row)
      for (const Point& p : curve->points) {
        if (!failed(p)) continue;
        refused = refused && p.record->status.kind == Status::Kind::unsupported;
        // A failed case may lack its measured abscissa (CPU time): then its glyph stands at the
        // edge.
        const double t = std::isfinite(p.x) ? chart.x.position(p.x * chart.x.quantity.scale) : 1;
        glyphs.emplace_back(area.left + t * (area.right - area.left), p.record->status.kind);
      }
    labels.place({{refused ? "cannot" : "failed", area.left - 8, y, Anchor::right, colour, 11}});
    put_glyphs(labels, std::move(glyphs), y, colour);
    y += kStripRow;
  }
}

/// Exact zeros have no place on a logarithmic axis: they lie on its floor, which then says so.
void put_zero(Labels& labels, const Chart& chart, const PlotArea& area) {
  const auto zero = [](const Point& p) { return p.measured() && p.y <= 0; };
  if (!chart.y.log || !chart.markers || std::ranges::none_of(chart.curves, [&](const Curve& c) {
        return std::ranges::any_of(c.points, zero);
      }))
    return;
  const double y = area.bottom - chart.y.position(floor_of(chart.y)) * (area.bottom - area.top);
  labels.put({"0", area.left - 9, y, Anchor::right, paint("muted")});
}

/// The reference's own error as a dotted line, or as a note on the axis if it lies below.
std::string place_floor(Labels& labels, const Chart& chart, const PlotArea& area) {
  const double floor = *chart.floor * chart.y.quantity.scale;
  const bool below = floor < chart.y.low, narrow = chart.width < kNarrow;
  const double t = below ? 0 : chart.y.position(std::min(floor, chart.y.high));
  const double y = area.bottom - t * (area.bottom - area.top);
  if (!below) labels.line(area.left, y, area.right, y);
  const std::string value = chart.y.quantity.text(*chart.floor, 2);
  const std::string text = floor > 0
                               ? (narrow ? "reference's: " : "reference's own error: ") + value +
                                     (!below   ? ""
                                      : narrow ? ", below"
                                               : ", below this plot")
                               : "the reference is exact";
  std::vector<Label> places;
  const double room = area.right - area.left - 16 - text_width(text, 11);
  for (const double share : {0.0, 1.0, 0.5, 0.25, 0.75})
    for (const double rise : below ? std::vector{8.0, 20.0} : std::vector{8.0, -9.0})
      places.push_back({text, area.left + 8 + share * std::max(0.0, room), y - rise, Anchor::left,
                        paint("muted"), 11});
  labels.place(places);
  return below ? ""
               : "set arrow from " + screen(area.left, y, chart) + " to " +
                     screen(area.right, y, chart) + " nohead dt (2,4) lw 1.4 lc rgb '" +
                     std::string(paint("axis")) + "'\n";
}

std::string slope_text(double slope) {
  return slope == std::round(slope) ? significant(slope, 1) : significant(slope, 2);
}

/// Along the line of the theory, below it where it can be.
void place_slope(Labels& labels, const Chart& chart, const PlotArea& area, double c) {
  const auto at = [&](double share) {
    const double x = chart.x.low * std::pow(chart.x.high / chart.x.low, share);
    const double y = c * std::pow(x, *chart.slope);
    // Not pixel_of(): that keeps to the plot, and this line leaves it.
    const double t = std::log(y / chart.y.low) / std::log(chart.y.high / chart.y.low);
    return std::pair(area.left + share * (area.right - area.left),
                     area.bottom - t * (area.bottom - area.top));
  };
  const auto [x0, y0] = at(0);
  const auto [x1, y1] = at(1);
  labels.line(x0, y0, x1, y1);
  const double angle = std::atan2(y0 - y1, x1 - x0);
  const std::string text = "theory: slope " + slope_text(*chart.slope);
  std::vector<Label> places;
  for (const double away : {11.0, -11.0})
    for (const double share : {0.35, 0.25, 0.2, 0.5, 0.65, 0.8}) {
      const auto [x, y] = at(share);
      const Label label{text,
                        x + away * std::sin(angle),
                        y + away * std::cos(angle),
                        Anchor::center,
                        paint("muted"),
                        11,
                        angle};
      const auto outside = [&](const std::pair<double, double>& p) {
        return p.first < area.left + 2 || p.first > area.right || p.second < area.top ||
               p.second > area.bottom - 2;
      };
      if (std::ranges::none_of(label.box().corners(), outside)) places.push_back(label);
    }
  labels.place(places);
}

/// Beside a marker, nearest first.
std::vector<Label> beside(double x, double y, const std::string& text, std::string_view colour) {
  std::vector<Label> places;
  const double half = text_width(text, 11) / 2;
  for (const auto& [dx, dy] : {std::pair(0.0, -12.0),
                               {0.0, 12.0},
                               {half + 8, 0.0},
                               {-half - 8, 0.0},
                               {half, -11.0},
                               {-half, -11.0},
                               {half, 11.0},
                               {-half, 11.0}})
    places.push_back({text, x + dx, y + dy, Anchor::center, colour, 11});
  return places;
}

/// The settings beside their points, as many as find room, those on the front first; the table has
/// them all.
void place_settings(Labels& labels, const Chart& chart, const PlotArea& area) {
  std::set<const Record*> front;
  for (const Point& p : pareto_front(chart.curves)) front.insert(p.record);
  std::vector<std::pair<Box, std::string>> named;  // curves that coincide share a name
  for (const bool first : {true, false})
    for (const Curve& curve : chart.curves)
      for (const Point& p : curve.points) {
        if (!p.measured() || !std::isfinite(p.along) || front.contains(p.record) != first) continue;
        const std::string text = p.name.empty() ? quantity("iterations").text(p.along, 2) : p.name;
        const auto [x, y] = pixel_of_point(chart, area, p);
        const Box marker{x, y, kMarker, kMarker};
        if (std::ranges::any_of(named, [&](const auto& other) {
              return other.second == text && other.first.meets(marker);
            }))
          continue;
        std::vector<Label> places = beside(x, y, text, paint(curve));
        std::erase_if(places, [&](const Label& label) {
          const Box box = label.box();
          return box.x - box.width / 2 < area.left + 2 || box.x + box.width / 2 > area.right + 6 ||
                 box.y - box.height / 2 < area.top || box.y + box.height / 2 > area.bottom - 2;
        });
        if (labels.place(places)) named.emplace_back(marker, text);
      }
}

}  // namespace

bool failed(const Point& p) {
  const auto kind = p.record->status.kind;
  return kind != Status::Kind::ok && kind != Status::Kind::unsettled;
}

double floor_of(const Axis& y) { return y.log ? y.low * std::pow(y.high / y.low, 0.035) : y.low; }

std::pair<double, double> pixel_of(const Chart& chart, const PlotArea& area, double x, double y) {
  return {
      area.left + chart.x.position(x) * (area.right - area.left),
      area.bottom - chart.y.position(std::max(y, floor_of(chart.y))) * (area.bottom - area.top)};
}

PlotArea chart_area(const Chart& chart) {
  const bool narrow = chart.width < kNarrow, above = named_above(chart);
  const double strip = static_cast<double>(failing_rows(chart).size()) * kStripRow;
  const double key =
      above && !chart.curves.empty() ? kKeyRow * (names_above(chart).back().row + 1) : 0;
  double ticks = 0;
  for (const auto& tick : chart.y.ticks) ticks = std::max(ticks, text_width(tick.second));
  return {std::max(narrow ? 52.0 : 68.0, ticks + (narrow ? 37 : 40)),
          chart.width - (above ? 14 : widest_name(chart) + 22),
          (chart.title.empty() ? 14 : 48) + strip + key,
          chart.height - 54.0,
          chart.x.low,
          chart.x.high};
}

double slope_factor(const Chart& chart) {
  if (!chart.slope || !chart.y.log) return std::numeric_limits<double>::quiet_NaN();
  double c = std::numeric_limits<double>::infinity();
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points)
      if (p.measured() && p.y > 0 && p.x > 0)
        c = std::min(
            c, p.y * chart.y.quantity.scale / std::pow(p.x * chart.x.quantity.scale, *chart.slope));
  return std::isfinite(c) ? 0.62 * c : std::numeric_limits<double>::quiet_NaN();
}

ChartTexts chart_texts(Chart& chart, const PlotArea& area) {
  ChartTexts texts{Labels(chart.width, chart.height), {}};
  Labels& labels = texts.labels;
  reserve_data(labels, chart, area);
  put_titles(labels, chart, area);
  put_zero(labels, chart, area);
  put_failures(labels, chart, area);
  texts.commands = put_names(labels, chart, area);
  reserve_ticks(labels, chart, area);
  if (chart.floor && chart.y.log) texts.commands += place_floor(labels, chart, area);
  if (const double c = slope_factor(chart); std::isfinite(c)) place_slope(labels, chart, area, c);
  if (chart.name_points) place_settings(labels, chart, area);
  return texts;
}

}  // namespace taut::report
