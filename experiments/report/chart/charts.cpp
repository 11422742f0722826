#include "experiments/report/chart/charts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/model/input_error.hpp"
#include "core/model/names.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::report {

namespace {

using Settings = std::map<std::string, std::string>;

/// All settings by which two cases of one solver may differ, by name, except those that are free.
Settings settings(const Record& record, const std::vector<std::string>& free) {
  Settings all = other_settings(record);
  if (record.substeps >= 0) all[kSubsteps] = std::to_string(record.substeps);
  if (record.sweeps >= 0) all[kSweeps] = std::to_string(record.sweeps);
  all["dt"] = quantity("dt").text(record.dt, 3);
  all["scene"] = record.scene;
  for (const SceneSetting& one : without(record.spec.settings, "time.dt"))
    all[one.key()] = one.value();
  for (const std::string& name : free) {
    all.erase(name == "vertices" ? "cloth.grid" : own_parameter(record.solver, name));
    if (name != "setting") continue;
    for (const char* work : {kSubsteps, kSweeps}) all.erase(work);
    for (const std::string& parameter : searched_parameters(record.solver)) all.erase(parameter);
  }
  return all;
}

bool is_setting(const std::string& name) {
  return name == kSweeps || name == "dt" || name == kSubsteps || name == "vertices";
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
    most = values.size();
    best = std::move(here);
    best.insert(best.end(), levels.begin(), levels.end());
  }
  return best;
}

std::string held_text(const std::string& setting, double value) {
  const Quantity q = quantity(setting);
  return q.unit.shown.empty() ? q.text(value, 3) + " " + q.title : q.title + " " + q.text(value, 3);
}

/// Positions from a file have no sweeps and no substeps: their value is a level across the chart.
void draw_levels(Chart& chart) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points)
      if (std::isfinite(p.x)) {
        low = std::min(low, p.x);
        high = std::max(high, p.x);
      }
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

/// Id of a value's chart within its scene: by the value's role, or by the value if several have it.
std::string id_of(const ValueSpec& value) {
  constexpr Names<Role::contact_error> kNames{"",      "convergence", "motion",    "vertices",
                                              "faces", "passages",    "reference", "elsewhere",
                                              "step",  "slip"};
  const std::vector<const ValueSpec*> all = values_with_role();
  const bool alone = std::ranges::count(all, value.role, &ValueSpec::role) == 1;
  return std::string(alone ? kNames[value.role] : value.name);
}

bool over_sweeps_alone(const ValueSpec& value) {
  return value.role == Role::error || value.role == Role::motion ||
         value.role == Role::reference_error || value.role == Role::motion_error ||
         value.role == Role::step_error;
}

std::string caption_of(const ValueSpec& value) {
  if (value.role == Role::reference_error)
    return "The reference is the static equilibrium of the same cloth, found without any of these "
           "solvers.";
  if (value.role == Role::step_error)
    return "The distance is that of each step (of each substep, if the solver has them) from its "
           "own start, without a reference in motion: cloth that is strained or late is far off.";
  if (value.role == Role::error) return capitalised(std::string(to_string(value.window))) + ".";
  return value.role == Role::vertex_depth || value.role == Role::face_depth
             ? "Peak over the whole run."
             : "";
}

}  // namespace

bool Point::measured() const {
  return completed(record->status) && std::isfinite(x) && std::isfinite(y);
}

std::vector<Curve> make_curves(const Records& records, const std::string& x, const std::string& y,
                               const std::string& along, const std::string& also) {
  const std::vector<std::string> free{along, also};
  std::map<std::pair<std::string, std::string>, std::set<std::string>> seen;
  for (const Record* record : records)
    for (const auto& [key, value] : settings(*record, free))
      seen[{key == "dt" || key == "scene" ? "" : record->solver, key}].insert(value);
  const auto varies = [&](const Record& record, const std::string& key) {
    return seen[{key == "dt" || key == "scene" ? "" : record.solver, key}].size() > 1;
  };
  std::vector<Curve> curves;
  std::map<std::pair<std::string, Settings>, std::size_t> index;  // by solver
  std::map<std::string, int> variants;
  const SettingLabels labels(records);
  for (const Record* one : records) {
    const Record& record = *one;
    const Settings all = settings(record, free);
    const auto [where, fresh] = index.try_emplace({record.solver, all}, curves.size());
    if (fresh) {
      Curve curve{solver_title(record.solver), record.solver, variants[record.solver]++, {}};
      for (const auto& [key, value] : all)
        if (varies(record, key)) curve.label += " " + named_setting(key, value);
      curves.push_back(std::move(curve));
    }
    Point point{value_of(record, x), value_of(record, y), value_of(record, along), &record};
    if (along == "setting") {
      point.along = point.x;
      const Label label = labels.parts(record);
      point.name = label.text();
      point.parts = label.size();
    }
    curves[where->second].points.push_back(std::move(point));
  }
  for (Curve& curve : curves)
    std::ranges::stable_sort(curve.points, {}, [](const Point& p) {
      return std::isnan(p.along) ? std::numeric_limits<double>::infinity() : p.along;
    });
  // Later curves are drawn above earlier ones: solver after solver, as the records have them.
  std::map<std::string, std::size_t> first;
  for (std::size_t i = 0; i < curves.size(); ++i) first.try_emplace(curves[i].solver, i);
  std::ranges::stable_sort(curves, {}, [&](const Curve& c) { return first.at(c.solver); });
  return curves;
}

Slice hold(const Records& records, const std::string& setting, double preferred) {
  std::map<double, int> counts;
  for (const Record* record : records)
    if (const double value = value_of(*record, setting); std::isfinite(value)) ++counts[value];
  if (counts.empty()) return {records, std::numeric_limits<double>::quiet_NaN()};
  const auto badness = [&](double value) { return std::abs(std::log(value / preferred)); };
  const auto best = std::ranges::max_element(counts, [&](const auto& a, const auto& b) {
    return std::pair(a.second, -badness(a.first)) < std::pair(b.second, -badness(b.first));
  });
  Slice slice{{}, best->first};
  for (const Record* record : records) {
    const double value = value_of(*record, setting);
    if (value == slice.value || std::isnan(value)) slice.records.push_back(record);
  }
  return slice;
}

void add_floor(Chart& chart) {
  const ValueSpec* value = find_value(chart.y.name).second;
  if (!value || value->floor.value.empty()) return;
  double highest = 0;
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points)
      highest = std::fmax(highest, value_of(*p.record, value->floor.value));
  if (value->floor.value == kStrainFloor)
    for (const TimeSeries& series : chart.series) highest = std::max(highest, series.floor);
  if (highest > 0) chart.floor = {highest, std::string(value->floor.text)};
}

bool failed(const Point& p) { return failed(p.record->status); }

std::vector<std::string> coincident_curves(const Chart& chart) {
  constexpr double kSame = 0.01;  // of the value: less is the width of a line
  const auto values = [](const Curve& curve) {
    std::map<double, double> y;
    for (const Point& p : curve.points)
      if (p.measured()) y[p.x] = p.y;
    return y;
  };
  std::vector<std::string> texts;
  constexpr std::size_t kMost = 12;  // of more curves nobody follows one
  if (chart.curves.size() > kMost) return texts;
  for (std::size_t j = 1; j < chart.curves.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) {
      const auto a = values(chart.curves[i]), b = values(chart.curves[j]);
      const bool zeros = std::ranges::all_of(b, [](const auto& p) { return p.second == 0; });
      double apart = a.size() == b.size() && a.size() > 1 && !zeros ? 0 : 1;
      for (auto one = a.begin(), other = b.begin(); apart < kSame && one != a.end(); ++one, ++other)
        apart = one->first != other->first ? 1
                : one->second == other->second
                    ? apart
                    : std::max(apart, std::abs(one->second - other->second) /
                                          std::max(std::abs(one->second), std::abs(other->second)));
      if (apart >= kSame) continue;
      texts.push_back(chart.curves[j].label + " lies on " + chart.curves[i].label + ": the same" +
                      (apart > 0 ? " to " + shown(kShare, apart, 1) : ""));
      break;
    }
  return texts;
}

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
      substeps.insert(work_of(*p.record).substeps);
      sweeps.insert(work_of(*p.record).sweeps);
      if (p.parts > 1) chart.join = false;
    }
    if (along == "setting" && substeps.size() > 1 && sweeps.size() > 1) chart.join = false;
  }
  std::erase_if(chart.curves, [](const Curve& c) { return c.points.empty(); });
  if (!any) throw InputError("no case has both '" + x + "' and '" + y + "'");
  if (is_setting(x)) chart.ticks.assign(values.begin(), values.end());
  return chart;
}

double theory_factor(const Chart& chart) {
  if (chart.factor) return *chart.factor;
  double factor = std::numeric_limits<double>::infinity();
  if (chart.slope)
    for (const Curve& curve : chart.curves)
      for (const Point& p : curve.points)
        if (p.measured() && p.x > 0 && p.y > 0)
          factor = std::min(factor, p.y / std::pow(p.x, *chart.slope));
  return std::isfinite(factor) ? 0.6 * factor : std::numeric_limits<double>::quiet_NaN();
}

std::string theory_text(const Chart& chart) {
  if (chart.x.name == kSweeps && *chart.slope == -1) return "theory of relaxation: 1/sweeps";
  if (*chart.slope == 1 && chart.factor == 1) return "as predicted";
  if (*chart.slope == 1) return "in proportion to " + chart.x.title;
  return "slope " + significant(*chart.slope, 2) + ", as the study says";
}

std::vector<Point> pareto_front(const Chart& chart) {
  std::vector<Point> points, front;
  for (const Curve& curve : chart.curves)
    for (const Point& p : curve.points)
      if (p.measured() && p.x > 0 && !chart.not_counted.contains(p.record->key))
        points.push_back(p);  // 0: nobody knows its work
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
                  .x = quantity(x, curve.solver),
                  .y = quantity(y, curve.solver)};
    std::set<double> columns, rows;
    for (const Point& p : curve.points) {
      columns.insert(p.x);
      rows.insert(p.y);
    }
    map.columns.assign(columns.begin(), columns.end());
    map.rows.assign(rows.begin(), rows.end());
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
  const double value = si * q.unit.scale;
  const bool whole = std::abs(value - std::round(value)) < 1e-6 * value && value < 99999.5;
  return whole ? exact(std::round(value)) : significant(value, 2);
}

std::vector<Chart> scene_charts(const ReportInput& input, const std::string& scene) {
  std::vector<Chart> charts;
  // Curves along the time step are of one number of sweeps, all others of one time step.
  const auto add = [&](const std::string& id, const std::string& kind, const std::string& x,
                       const std::string& y, const std::string& caption,
                       const std::string& along = "") {
    const std::string held = x == "dt" ? kSweeps : "dt";
    const Slice slice = hold(records_along(input, scene, x, y), held);
    try {
      Chart chart = make_chart(kind, slice.records, x, y, along.empty() ? x : along);
      chart.id = scene + "-" + id;
      chart.scene = scene;
      chart.caption = caption;
      chart.title =
          capitalised(chart.y.title) + " over " + (x == "dt" ? "the time step" : chart.x.title);
      add_floor(chart);
      if (std::isfinite(slice.value)) chart.held = held_text(held, slice.value);
      charts.push_back(std::move(chart));
      return true;
    } catch (const InputError&) {
      return false;  // nothing to draw
    }
  };
  const std::vector<const ValueSpec*> values = values_with_role();
  for (const ValueSpec* value : values) {
    if (!over_sweeps_alone(*value)) continue;
    const std::string y(value->name);
    if (!add(id_of(*value), "convergence", kSweeps, y, caption_of(*value))) continue;
    for (const StudyResult& study : input.studies)
      if (const auto at = study.slopes.find(scene);
          value->falls_with_sweeps && at != study.slopes.end())
        charts.back().slope = at->second;
  }
  if (add("predicted", "convergence", std::string(kPredicted), std::string(kStretch),
          "What sweeps leave at rest, measured over predicted without a run: on the line both are "
          "equal.",
          "setting")) {
    charts.back().slope = charts.back().factor = 1;
    charts.back().join = false;
  }
  for (const ValueSpec* value : values) {
    if (over_sweeps_alone(*value)) continue;
    const std::string y(value->name);
    add(id_of(*value), "contact", kSweeps, y, caption_of(*value));
    add(id_of(*value) + "-dt", "contact", "dt", y, caption_of(*value));
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
      if (r.scene == scene) {
        sweeps.insert(value_of(r, kSweeps));
        steps.insert(r.dt);
      }
    if (steps.size() >= 3 && sweeps.size() >= 3) add(study.name, study.records, "dt", kSweeps);
  }
  for (const MapResult& map : input.maps) {
    const auto ran = std::ranges::find(input.studies, map.study, &StudyResult::name);
    add(map.study, map.records.empty() && ran != input.studies.end() ? ran->records : map.records,
        map.x, map.y);
  }
  return maps;
}

Chart cost_chart(const SceneBench& scene, const Records& records) {
  const std::string metric = scene.deciding_metric();
  Chart chart = make_chart("cost", records, kCpuPerSecond, metric, "setting");
  chart.id = slug(scene.scene) + "-cost";
  chart.scene = scene.scene;
  chart.title = capitalised(chart.y.title) + " over " + chart.x.title;
  chart.caption = "Down and left is better.";
  chart.front = true;
  const std::vector<Candidate> candidates = scene.candidates(metric);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const BenchedCase& c = scene.cases[i];
    const Candidate& one = candidates[i];
    if (c.stable()) chart.cost[c.record.key] = c.cost();
    if (one.is_uncounted()) chart.not_counted[c.record.key] = one.failure;
  }
  return chart;
}

}  // namespace taut::report
