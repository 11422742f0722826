#include "experiments/study/limits.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/model/input_error.hpp"
#include "core/model/scene.hpp"
#include "core/model/text.hpp"
#include "experiments/answer/number.hpp"

namespace taut {

std::string Limit::text(double value) const {
  return std::isfinite(value) ? number_text(value, unit_of_value(name)) : "-";
}

std::string name_of_kept(const std::string& asked, const std::vector<std::string>& names) {
  const std::string name = asked.substr(0, asked.find(':'));
  if (std::ranges::find(names, name) == names.end())
    throw InputError("--keep " + asked + ": unknown metric value '" + name + "'" +
                     suggestion(name, names));
  return name;
}

double number_of_kept(const std::string& asked, const Unit& known, double hundred) {
  std::string_view unit = std::string_view(asked).substr(asked.find(':') + 1);
  const std::optional<double> number = take_number(unit);
  const bool shown = unit == known.shown && known.kind != Unit::Kind::share;
  const bool share = unit == "%" && !std::isnan(hundred);
  if (!number || !std::isfinite(*number) || *number < 0 || !(unit.empty() || share || shown)) {
    std::vector<std::string> units;
    if (!known.shown.empty() && known.kind != Unit::Kind::share)
      units.push_back("'" + std::string(known.shown) + "'");
    if (!std::isnan(hundred)) units.emplace_back("'%'");
    throw InputError("--keep " + asked + ": expected a number of at least 0 after ':'" +
                     (units.empty() ? "" : " and then " + join(units, ", ") + " or nothing"));
  }
  return share ? *number / 100 * hundred : shown && !unit.empty() ? *number / known.scale : *number;
}

double hundred_percent(const Unit& unit, const Scene& scene) {
  switch (unit.kind) {
    case Unit::Kind::length:
      return extent(scene);
    case Unit::Kind::time:
      return scene.duration();
    case Unit::Kind::share:
      return 1;
    case Unit::Kind::count:
    case Unit::Kind::other:
      break;
  }
  return std::nan("");
}

Limit parse_limit(const std::string& asked, const Scene& scene) {
  const Limit limit{name_of_kept(asked, value_names()), 0};
  if (asked.find(':') == std::string::npos)
    throw InputError("--keep " + asked + ": expected a limit after ':', as in " + asked + ":1%");
  if (!find_value(limit.name).first->make(scene))
    throw InputError("--keep " + asked + ": has no value on this scene");
  const Unit unit = unit_of_value(limit.name);
  return {limit.name, number_of_kept(asked, unit, hundred_percent(unit, scene))};
}

std::vector<Limit> default_limits(const Scene& scene) {
  std::vector<Limit> all;
  for (const MetricEntry* metric : metrics()) {
    if (!metric->make(scene)) continue;
    for (const ValueSpec& value : metric->values) {
      const bool depth = value.role == Role::vertex_depth;
      if (depth || value.role == Role::passages ||
          (value.kept && value.unit.kind == Unit::Kind::count))
        all.push_back({std::string(value.name), depth ? kMostDepth * extent(scene) : 0});
      if (value.role == Role::error) all.push_back({std::string(value.name), kMostStretch});
    }
  }
  return all;
}

std::string beyond(const Record& record, const std::vector<Limit>& limits) {
  std::string said;
  for (const Limit& limit : limits)
    if (const double value = std::abs(record.value(limit.name)); value > limit.most)
      said += (said.empty() ? "" : "; ") + limit.name + " " + limit.text(value) + ", more than " +
              limit.text(limit.most);
  return said;
}

}  // namespace taut
