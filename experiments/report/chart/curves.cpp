#include "experiments/report/chart/curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "experiments/case/record_io.hpp"
#include "experiments/report/chart/wording.hpp"

namespace taut::report {

namespace {

using Settings = std::map<std::string, std::string>;

/// Everything that tells two cases of one solver apart, by name, but for what is free.
Settings settings(const Record& record, const std::vector<std::string>& free) {
  Settings all = record.params;
  all["dt"] = quantity("dt").text(record.dt, 3);
  all["scene"] = record.scene;
  for (const std::string& text : record.spec.overrides)
    if (!text.starts_with("time.dt"))
      if (const auto equals = text.find('='); equals != std::string::npos)
        all[text.substr(0, equals)] = text.substr(equals + 1);
  for (const std::string& name : free) {
    all.erase(name == "vertices" ? "cloth.grid" : parameter_of(record.solver, name));
    if (name != "setting") continue;
    for (const std::string& parameter : accuracy_parameters(record.solver)) all.erase(parameter);
  }
  return all;
}

/// What a setting adds to a label: "mesh" speaks for itself, "4" and "on" do not.
std::string in_label(const Record& record, const std::string& key, const std::string& value) {
  for (const auto& [name, counted] : {std::pair{kSweeps, " sweeps"}, {kSubsteps, " substeps"}})
    if (key == parameter_of(record.solver, name)) return value + counted;
  const bool word = value != "on" && value != "off" &&
                    value.find_first_not_of("0123456789.+-e/") != std::string::npos;
  return word ? value : key + "=" + value;
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
        if (varies(record, key)) curve.label += " " + in_label(record, key, value);
      curves.push_back(std::move(curve));
    }
    Point point{value_of(record, x), value_of(record, y), value_of(record, along), &record};
    if (along == "setting") point.along = point.x, point.name = labels.of(record);
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
  constexpr std::size_t kMostSets = 3;
  std::map<double, int> counts;
  for (const Record* record : records)
    if (const double value = value_of(*record, setting); std::isfinite(value)) ++counts[value];
  if (counts.empty() || (counts.size() > 1 && counts.size() <= kMostSets))
    return {records, std::numeric_limits<double>::quiet_NaN()};
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

double fitted_slope(const Curve& curve, double from) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Point& p : curve.points) {
    if (!p.measured() || p.x < from || p.x <= 0 || p.y <= 0) continue;
    const double u = std::log(p.x), v = std::log(p.y);
    n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  const double spread = n * sxx - sx * sx;
  if (n < 3 || spread <= 0) return std::numeric_limits<double>::quiet_NaN();
  return (n * sxy - sx * sy) / spread;
}

}  // namespace taut::report
