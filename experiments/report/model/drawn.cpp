#include <algorithm>
#include <cmath>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/task.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/charts.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/palette.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/model/parts.hpp"

namespace taut::report {

namespace {

Json json_of_axis(const Quantity& q, const std::vector<double>& ticks) {
  Json axis{{"metric", q.name},
            {"title", q.title},
            {"unit", q.unit.shown},
            {"scale", q.unit.scale},
            {"axis", q.unit.logarithmic ? "log" : "linear"}};
  if (ticks.empty()) return axis;
  axis["values"] = ticks;
  for (const double value : ticks) axis["texts"].push_back(tick_of(q, value));
  return axis;
}

Json json_of(const Point& p, const Chart& chart, CaseList& refs) {
  const bool none = failed(p);
  Json point{{"x", json_number(p.x)},
             {"y", none ? Json() : json_number(p.y)},
             {"status", to_string(p.record->status.kind)},
             {"case", refs.key(*p.record)},
             {"failed", none},
             {"zero", !none && p.y == 0}};
  if (const auto cost = chart.cost.find(p.record->key); cost != chart.cost.end()) {
    point["x_low"] = cost->second.low;
    point["x_high"] = cost->second.high;
  }
  add_if(point, "name", p.name.empty() ? work_of(*p.record).text() : p.name);
  if (const auto why = chart.not_counted.find(p.record->key); why != chart.not_counted.end())
    point["not_counted"] = why->second;
  return point;
}

Json json_of(const Scale& scale) {
  return {{"axis", scale.logarithmic ? "log" : "linear"}, {"low", scale.low}, {"high", scale.high}};
}

Json json_of(const Frame& frame) {
  return {{"x", json_of(frame.x)}, {"y", json_of(frame.y)}, {"least", frame.least}};
}

/// Scale for values over time. It includes zero; rounding below a millionth of the unit lies on the
/// axis.
Scale scale_of_series(const std::vector<TimeSeries>& all, const Unit& unit) {
  std::vector<double> values{0};
  for (const TimeSeries& series : all)
    for (const double y : series.y) values.push_back(y * unit.scale);
  const bool any = std::ranges::any_of(values, [](double v) { return v > 0; });
  if (any) values.push_back(1e-6 * unit.scale);
  return scale_of(false, values);
}

/// A series as JSON, with its times and values.
Json json_of(const TimeSeries& series, Variants& variants, CaseList& refs) {
  Json one{{"solver", series.solver},
           {"label", series.label},
           {"dash", dash_of(series.solver, variants.of(series.solver, series.label))}};
  for (const double t : series.t) one["t"].push_back(rounded_to(t, 5));
  for (const double y : series.y)
    one["y"].push_back(std::isfinite(y) ? Json(rounded_to(y, 4)) : Json());
  add_if(one, "case", refs.key(series.key));
  return one;
}

Json json_of_tracks(const std::string& scene, double until, const ReportInput& input,
                    CaseList& refs) {
  std::map<std::string, std::vector<TimeSeries>> by_value;
  for (const TimeSeries& series : input.series) {
    if (series.scene != scene) continue;
    TimeSeries cut = series;
    const auto end = std::ranges::upper_bound(cut.t, until + 1e-9) - cut.t.begin();
    cut.t.resize(static_cast<std::size_t>(end));
    cut.y.resize(static_cast<std::size_t>(end));
    if (cut.t.size() > 1) by_value[series.value].push_back(std::move(cut));
  }
  // The scene's own quantities come before errors, which every scene has. Values that are zero up
  // to rounding are not shown.
  constexpr double kNoise = 1e-6;
  const auto place = [&](const std::string& value) {
    double largest = 0;
    for (const TimeSeries& series : input.series)
      if (series.scene == scene && series.value == value)
        for (const double y : series.y)
          if (std::isfinite(y)) largest = std::max(largest, std::abs(y));
    const ValueSpec* spec = find_value(value).second;
    return largest < kNoise ? 2 : spec && spec->role == Role::error ? 1 : 0;
  };
  Json tracks;
  for (const int wanted : {0, 1})
    for (const auto& [value, series] : by_value) {
      if (place(value) != wanted) continue;
      const Quantity& q = refs.use(value);
      Json track{{"metric", value},
                 {"title", capitalised(q.title)},
                 {"range", json_of(scale_of_series(series, q.unit))}};
      Variants variants;
      for (const TimeSeries& one : series) track["series"].push_back(json_of(one, variants, refs));
      tracks.push_back(std::move(track));
    }
  return tracks;
}

Json json_of(const ColourBar& bar) {
  Json one{{"title", bar.title}, {"stops", bar.stops}};
  for (const auto& [at, text] : bar.ticks) one["ticks"].push_back({{"at", at}, {"text", text}});
  return one;
}

}  // namespace

Json json_interval(const Interval& i, std::size_t n) {
  return {{"low", json_number(i.low)},
          {"mid", json_number(i.mid)},
          {"high", json_number(i.high)},
          {"n", n}};
}

namespace {

/// Adds a chart's curves: all points of a small chart, or as many points of a large one as a page
/// can draw, with a sentence on what is left out.
void add_curves(Json& one, const Chart& chart, CaseList& refs) {
  std::size_t all = 0, failures = 0;
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points) {
      ++all;
      failures += failed(p);
    }
  const std::vector<std::size_t> places =
      places_of(chart.curves.size(), all > kMostPoints ? kMostCurves : chart.curves.size());
  std::size_t drawn = 0;
  for (const std::size_t i : places) {
    const Curve& curve = chart.curves[i];
    Json series{{"solver", curve.solver},
                {"label", curve.label},
                {"dash", dash_of(curve.solver, curve.variant)},
                {"join", chart.join}};
    for (const std::size_t k : places_of(curve.points.size(), kMostPoints / places.size())) {
      series["points"].push_back(json_of(curve.points[k], chart, refs));
      ++drawn;
      failures -= failed(curve.points[k]);
    }
    one["series"].push_back(std::move(series));
  }
  if (drawn < all)
    one["thinned"] = "Drawn: " + std::to_string(drawn) + " of " + std::to_string(all) +
                     " points, on " + std::to_string(places.size()) + " of " +
                     std::to_string(chart.curves.size()) + " curves; " + std::to_string(failures) +
                     " cases that failed are among the others.";
}

bool all_zero(const Chart& chart) {
  return std::ranges::all_of(chart.curves, [](const Curve& curve) {
    return std::ranges::all_of(curve.points, [](const Point& p) { return failed(p) || p.y == 0; });
  });
}

}  // namespace

Json json_of(const Chart& chart, CaseList& refs) {
  Json one{{"id", chart.id},
           {"scene", chart.scene},
           {"kind", chart.kind},
           {"title", chart.title},
           {"caption", chart.caption},
           {"x", json_of_axis(refs.use(chart.x.name), chart.ticks)},
           {"y", json_of_axis(refs.use(chart.y.name), {})}};
  add_if(one, "held", chart.held);
  add_curves(one, chart, refs);
  Variants variants;
  for (const TimeSeries& series : chart.series)
    one["series"].push_back(json_of(series, variants, refs));
  if (!chart.series.empty()) one["range"] = json_of(scale_of_series(chart.series, chart.y.unit));
  if (const double factor = theory_factor(chart); std::isfinite(factor))
    one["theory"] = {{"slope", *chart.slope}, {"factor", factor}, {"text", theory_text(chart)}};
  if (chart.floor) one["floor"] = {{"y", chart.floor->y}, {"text", chart.floor->text}};
  if (chart.front)
    for (const Point& p : pareto_front(chart))
      one["front"].push_back({{"x", p.x}, {"y", p.y}, {"case", refs.key(*p.record)}});
  if (all_zero(chart) && !chart.curves.empty())
    one["zeros"] = true;
  else
    add_if(one, "same", coincident_curves(chart));
  return one;
}

void add_figure(DrawnCharts& drawn, std::string_view of, const Figure& figure, CaseList& refs) {
  const bool logarithmic = is_logarithmic(figure.charts);
  Json one{{"of", of},
           {"title", figure.title},
           {"axis", logarithmic ? "log" : "linear"},
           {"linear", json_of(frame_of(figure.charts, false))}};
  if (any_positive(figure.charts)) one["log"] = json_of(frame_of(figure.charts, true));
  for (const Chart& chart : figure.charts)
    add_by_id(one, "charts", json_of(chart, refs), drawn.charts);
  drawn.figures.push_back(std::move(one));
}

Json json_of(const StatusMap& map, const std::string& id, CaseList& refs) {
  for (const Quantity& axis : {map.x, map.y}) refs.use(axis.name);
  Json one{{"id", id},
           {"scene", map.scene},
           {"solver", map.solver},
           {"label", map.label},
           {"title", "How cases end over " + map.x.title + " and " + map.y.title},
           {"study", map.study},
           {"x", json_of_axis(map.x, map.columns)},
           {"y", json_of_axis(map.y, map.rows)}};
  SceneSettings common = task_of(*map.cells.front().record).settings;
  for (const StatusMap::Cell& cell : map.cells)
    std::erase_if(common, [&](const SceneSetting& setting) {
      const auto own = task_of(*cell.record).settings;
      return std::ranges::find(own, setting) == own.end();
    });
  add_if(one, "scene_settings", join(common, ", ", &SceneSetting::text));
  for (const StatusMap::Cell& cell : map.cells) {
    const Status& status = cell.record->status;
    Json at{{"column", cell.column},
            {"row", cell.row},
            {"status", to_string(status.kind)},
            {"case", refs.key(*cell.record)}};
    add_if(at, "reason", status.reason.text());
    if (const double error = cell.record->value(kErrorMetric);
        completed(status) && std::isfinite(error))
      at["value"] = rounded_to(error, 3);
    one["cells"].push_back(std::move(at));
  }
  return one;
}

Json json_of(const SceneMedia& media, const ReportInput& input, CaseList& refs,
             std::size_t& budget) {
  const Footage& footage = media.footage;
  Json film{{"id", "film-" + media.scene}, {"scene", media.scene}, {"type", footage.type}};
  const std::size_t weight = (footage.bytes.size() + footage.poster.size()) * 4 / 3;
  if (weight > budget) {
    film["left_out"] = "The page would become too large: taut render " + media.scene;
  } else {
    budget -= weight;
    film["src"] = "data:" + footage.type + ";base64," + base64(footage.bytes);
    if (!footage.poster.empty())
      film["poster"] = "data:" + footage.poster_type + ";base64," + base64(footage.poster);
  }
  film["poster_t"] = footage.poster_t;
  film["duration"] = footage.duration;
  film["frame"] = footage.frame;
  film["speed"] = footage.speed;
  film["alt"] = footage.alt;
  for (const SceneMedia::Panel& panel : media.panels) {
    Json one{{"solver", panel.solver}, {"settings", panel.settings}};
    add_if(one, "case", refs.key(panel.key));
    film["panels"].push_back(std::move(one));
  }
  if (!media.panels.empty()) film["columns"] = footage.columns;
  if (!footage.bar.stops.empty()) film["bar"] = json_of(footage.bar);
  add_if(film, "tracks", json_of_tracks(media.scene, footage.duration, input, refs));
  return film;
}

}  // namespace taut::report
