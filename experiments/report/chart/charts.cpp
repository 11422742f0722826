#include "experiments/report/chart/charts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/model/input_error.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/settings.hpp"

namespace taut::report {

namespace {

bool is_setting(const std::string& name) {
  return name == "iterations" || name == "dt" || name == "substeps" || name == "vertices";
}

bool plays_a_file(const Record& r) { return std::isfinite(value_of(r, kStrainFloor)); }

/// The study with most distinct values of `setting` on a scene, cut to that scene; empty if none
/// has two. Only records with a value of `needs` make a study count.
Records records_along(const ReportInput& input, const std::string& scene,
                      const std::string& setting, const std::string& needs) {
  Records best;
  std::size_t most = 1;
  for (const StudyResult& study : input.studies) {
    Records here, levels;
    std::set<double> values;
    bool any = needs.empty();
    for (const Record& r : study.records) {
      const double value = value_of(r, setting);
      if (r.scene != scene) continue;
      if (is_setting(setting) && plays_a_file(r)) levels.push_back(&r);
      if (!std::isfinite(value)) continue;
      any = any || std::isfinite(value_of(r, needs));
      values.insert(value);
      here.push_back(&r);
    }
    if (!any || values.size() <= most) continue;
    most = values.size(), best = std::move(here);
    best.insert(best.end(), levels.begin(), levels.end());
  }
  return best;
}

std::string held_text(const std::string& setting, double value) {
  const Quantity q = quantity(setting);
  return q.unit.empty() ? q.text(value, 3) + " " + q.title : q.title + " " + q.text(value, 3);
}

constexpr const char* kRounding = "rounding of the file of positions";

void raise_floor(Chart& chart, double y, const char* text) {
  if (y > 0 && !(chart.floor && chart.floor->y >= y)) chart.floor = {y, text};
}

/// Positions from a file have no sweeps and no substeps: their value is a level across the chart.
void draw_levels(Chart& chart) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points)
      if (std::isfinite(p.x)) low = std::min(low, p.x), high = std::max(high, p.x);
  for (Curve& curve : chart.curves) {
    Point level = curve.points.front();
    if (!(low < high) || std::isfinite(level.x) || !plays_a_file(*level.record)) continue;
    curve.points.clear();
    for (const double x : {low, high}) {
      level.x = level.along = x;
      curve.points.push_back(level);
    }
  }
}

}  // namespace

void add_strain_floor(Chart& chart) {
  if (!chart.y.name.starts_with("stretch.")) return;
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points)
      raise_floor(chart, value_of(*p.record, kStrainFloor), kRounding);
  for (const TimeSeries& series : chart.series) raise_floor(chart, series.floor, kRounding);
}

bool failed(const Point& p) { return !completed(p.record->status); }

Chart make_chart(std::string kind, const Records& records, const std::string& x,
                 const std::string& y, const std::string& along) {
  Chart chart{.id = {},
              .kind = std::move(kind),
              .x = quantity(x),
              .y = quantity(y),
              .along = along,
              .curves = make_curves(records, x, y, along)};
  if (is_setting(x)) draw_levels(chart);
  bool any = false;
  std::set<double> values;
  for (Curve& curve : chart.curves) {
    std::erase_if(curve.points, [](const Point& p) { return !p.measured() && !failed(p); });
    for (const Point& p : curve.points) {
      any = any || p.measured();
      if (std::isfinite(p.x)) values.insert(p.x);
    }
    // A line through settings that differ in two parameters would join what nobody tries in a row.
    std::set<int> substeps, sweeps;
    for (const Point& p : curve.points) {
      substeps.insert(work_of(*p.record).substeps), sweeps.insert(work_of(*p.record).sweeps);
      if (p.name.find(',') != std::string::npos) chart.join = false;
    }
    if (along == "setting" && substeps.size() > 1 && sweeps.size() > 1) chart.join = false;
  }
  std::erase_if(chart.curves, [](const Curve& c) { return c.points.empty(); });
  if (!any) throw InputError("no case has both '" + x + "' and '" + y + "'");
  if (is_setting(x)) chart.ticks.assign(values.begin(), values.end());
  return chart;
}

double theory_factor(const Chart& chart) {
  double factor = std::numeric_limits<double>::infinity();
  if (chart.slope)
    for (const Curve& curve : chart.curves)
      for (const Point& p : curve.points)
        if (p.measured() && p.x > 0 && p.y > 0)
          factor = std::min(factor, p.y / std::pow(p.x, *chart.slope));
  return std::isfinite(factor) ? 0.6 * factor : std::numeric_limits<double>::quiet_NaN();
}

std::vector<Point> pareto_front(const Chart& chart) {
  std::vector<Point> points, front;
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points)
      if (p.measured() && p.x > 0) points.push_back(p);  // 0: nobody knows its work
  std::ranges::sort(points, {}, [](const Point& p) { return std::pair(p.x, p.y); });
  for (const Point& p : points)
    if (front.empty() || p.y < front.back().y) front.push_back(p);
  return front;
}

std::vector<StatusMap> make_maps(const Records& records, const std::string& scene,
                                 const std::string& x, const std::string& y) {
  Records all = records;
  std::erase_if(all, [&](const Record* r) {
    return r->scene != scene || !std::isfinite(value_of(*r, x)) || !std::isfinite(value_of(*r, y));
  });
  std::vector<StatusMap> maps;
  for (const Curve& curve : make_curves(all, x, y, x, y)) {
    StatusMap map{.scene = scene,
                  .solver = curve.solver,
                  .label = curve.label,
                  .x = quantity(x),
                  .y = quantity(y)};
    std::set<double> columns, rows;
    for (const Point& p : curve.points) columns.insert(p.x), rows.insert(p.y);
    map.columns.assign(columns.begin(), columns.end()), map.rows.assign(rows.begin(), rows.end());
    const auto index = [](const std::vector<double>& values, double value) {
      return static_cast<std::size_t>(std::ranges::lower_bound(values, value) - values.begin());
    };
    std::map<std::pair<std::size_t, std::size_t>, StatusMap::Cell> cells;
    for (const Point& p : curve.points) {
      const std::size_t column = index(map.columns, p.x), row = index(map.rows, p.y);
      const auto [at, fresh] = cells.try_emplace({row, column});
      if (!fresh && at->second.record->status.kind >= p.record->status.kind) continue;
      at->second = {column, row, p.record};
    }
    for (const auto& [at, cell] : cells) map.cells.push_back(cell);
    maps.push_back(std::move(map));
  }
  if (maps.empty()) throw InputError("no case has both '" + x + "' and '" + y + "'");
  return maps;
}

std::string tick_of(const Quantity& q, double si) {
  const double shown = si * q.scale;
  const bool whole = std::abs(shown - std::round(shown)) < 1e-6 * shown && shown < 99999.5;
  return whole ? exact(std::round(shown)) : significant(shown, 2);
}

std::vector<Chart> scene_charts(const ReportInput& input, const std::string& scene) {
  std::vector<Chart> charts;
  // Curves along the time step are of one number of sweeps, all others of one time step.
  const auto add = [&](const std::string& id, const std::string& kind, const std::string& x,
                       const std::string& y, const std::string& along, const std::string& caption) {
    const std::string over = along == "setting" ? "iterations" : along,
                      held = along == "dt" ? "iterations" : "dt";
    const Slice slice =
        hold(records_along(input, scene, over, y), held, held == "dt" ? 1.0 / 64 : 16);
    try {
      Chart chart = make_chart(kind, slice.records, x, y, along);
      chart.id = scene + "-" + id, chart.scene = scene, chart.caption = caption;
      chart.title =
          capitalised(chart.y.title) + " over " + (x == "dt" ? "the time step" : chart.x.title);
      add_strain_floor(chart);
      if (std::isfinite(slice.value)) chart.held = held_text(held, slice.value);
      charts.push_back(std::move(chart));
      return true;
    } catch (const InputError&) {
      return false;  // nothing to draw
    }
  };
  if (add("convergence", "convergence", "iterations", "stretch.rms", "iterations", "Last second."))
    for (const StudyResult& study : input.studies)
      if (const auto at = study.slopes.find(scene); at != study.slopes.end())
        charts.back().slope = at->second;
  if (add("reference", "convergence", "iterations", "reference.rms", "iterations",
          "The reference is the static equilibrium of the same cloth, found without any of these "
          "solvers."))
    for (const Curve& curve : charts.back().curves)
      for (const Point& p : curve.points)
        raise_floor(charts.back(), value_of(*p.record, "reference.floor"),
                    "the reference's own error");
  const bool timed =
      std::ranges::any_of(records_along(input, scene, "iterations", "stretch.rms"),
                          [](const Record* r) { return std::isfinite(value_of(*r, kCpuValue)); });
  if (add("work", "work-precision", timed ? kCpuValue : "projections", "stretch.rms", "setting",
          "Down and left is better."))
    charts.back().front = true;
  for (const auto& [y, id] : {std::pair<std::string, std::string>{"penetration.peak", "vertices"},
                              {"face.peak", "faces"},
                              {"tunnelling.events", "passages"},
                              {"slip.distance", "slip"}}) {
    const std::string caption = y.ends_with(".peak") ? "Peak over the whole run." : "";
    add(id, "contact", "iterations", y, "iterations", caption);
    add(id + "-dt", "contact", "dt", y, "dt", caption);
  }
  return charts;
}

std::vector<StatusMap> scene_maps(const ReportInput& input, const std::string& scene) {
  std::vector<StatusMap> maps;
  const auto add = [&](const std::string& study, const Records& records, const std::string& x,
                       const std::string& y) {
    try {
      for (StatusMap& map : make_maps(records, scene, x, y)) {
        if (map.columns.size() < 2 || map.rows.size() < 2) continue;
        map.study = study;
        maps.push_back(std::move(map));
      }
    } catch (const InputError&) {
      return;  // this study has no such settings
    }
  };
  for (const StudyResult& study : input.studies) {
    std::set<double> sweeps, steps;
    for (const Record& r : study.records)
      if (r.scene == scene) sweeps.insert(value_of(r, "iterations")), steps.insert(r.dt);
    if (steps.size() >= 3 && sweeps.size() >= 3) add(study.name, study.records, "dt", "iterations");
  }
  for (const MapResult& map : input.maps) {
    const auto ran = std::ranges::find(input.studies, map.study, &StudyResult::name);
    add(map.study, map.records.empty() && ran != input.studies.end() ? ran->records : map.records,
        map.x, map.y);
  }
  return maps;
}

Chart cost_chart(const SceneBench& scene, const Records& records) {
  Chart chart = make_chart("cost", records, "cpu.per_second", "stretch.rms", "setting");
  chart.id = scene.scene + "-cost", chart.scene = scene.scene;
  chart.title = capitalised(chart.y.title) + " over " + chart.x.title;
  chart.caption =
      "Down and left is better. Two runs of identical code: " + fixed(scene.control.low, 2) +
      " to " + fixed(scene.control.high, 2) + ".";
  chart.front = true;
  for (const BenchedCase& c : scene.cases)
    if (c.stable()) chart.cost[c.record.key] = c.cost();
  return chart;
}

}  // namespace taut::report
