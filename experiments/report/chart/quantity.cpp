#include "experiments/report/chart/quantity.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/settings.hpp"

namespace taut::report {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr Unit kMilliseconds{"s", "ms", 1e3}, kCost{"s", "ms", 1e3, true, true};

/// What is no metric's value: settings, sizes and costs.
struct Titled {
  std::string_view name, title;
  Unit unit;
  std::string_view help = "";
};
constexpr std::array kTitles{
    Titled{"dt", "time step", kMilliseconds},
    Titled{kSweeps, "sweeps per substep", kNumber},
    Titled{kSubsteps, "substeps per step", kNumber},
    Titled{"steps", "steps", kNumber},
    Titled{"t", "simulated time", kTime},
    Titled{"projections", "constraint projections per step", kNumber},
    Titled{"vertices", "vertices", kNumber},
    Titled{"links", "links", kNumber},
    Titled{"cpu.per_second", "CPU time per simulated second", kCost,
           "median of samples that alternate between the solvers, one thread's time"},
    Titled{"cpu.per_step", "CPU time per step", kCost,
           "median of samples that alternate between the solvers, one thread's time"},
    Titled{"wall.per_step", "wall time per step", kCost, "median of the same samples"},
    Titled{"memory.peak", "peak memory of the process", {"bytes", "MB", 1e-6}},
    Titled{"structural", "structural links: stiffness in N/m, of xpbd compliance in m/N", kNumber},
    Titled{"omega", "relaxation factor", kNumber},
    Titled{"cloth.weights.0.factor", "mass ratio", kNumber},
};

/// The number that makes up all of the text; NaN if none does.
double number(const std::string& text) {
  double value = kNaN;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  return parsed.ec == std::errc() && parsed.ptr == end ? value : kNaN;
}

/// The last number that the case gives a scene key; NaN if none.
double overridden(const Record& record, const std::string& key) {
  double value = kNaN;
  for (const std::string& text : record.spec.overrides)
    if (text.starts_with(key + "=")) value = number(text.substr(key.size() + 1));
  return value;
}

/// "stretch.max" -> "largest stretch"
std::string title_from(std::string_view name) {
  std::string title(name);
  std::ranges::replace_if(
      title, [](char c) { return c == '.' || c == '_'; }, ' ');
  for (const auto& [from, to] : {std::pair<std::string, std::string>{" rms", "RMS "},
                                 {" max", "largest "},
                                 {" peak", "peak "},
                                 {" p95", "95th percentile "},
                                 {" mean", "mean "}})
    if (title.ends_with(from)) title = to + title.substr(0, title.size() - from.size());
  return title;
}

}  // namespace

double value_of(const Record& record, std::string_view name) {
  if (name == "dt") return record.dt;
  if (name == "steps") return record.steps;
  if (name == "vertices") return record.vertices;
  if (name == "links") return record.links;
  if (name == "projections") return static_cast<double>(record.projections);
  if (name == kStrainFloor) {
    for (const auto& [line, text] : record.resolved_settings)
      if (line == "floor of strain") return std::strtod(text.c_str(), nullptr);
    return kNaN;
  }
  const std::string key(name);
  if (const auto value = record.values.find(key); value != record.values.end())
    return value->second;
  const auto param = record.params.find(parameter_of(record.solver, key));
  return param == record.params.end() ? overridden(record, key) : number(param->second);
}

std::string shown(const Unit& unit, double si, int digits) {
  const bool counted = unit.shown.empty() && si == std::round(si) && std::abs(si) < 1e7;
  const std::string number = counted ? exact(si) : significant(si * unit.scale, digits);
  return unit.shown.empty() || !std::isfinite(si) ? number
                                                  : number + "\u00A0" + std::string(unit.shown);
}

std::string Quantity::label() const {
  return unit.shown.empty() ? title : title + " [" + std::string(unit.shown) + "]";
}

Quantity quantity(std::string_view name) {
  std::string own(name);
  if (const auto known = std::ranges::find(kTitles, name, &Titled::name); known != kTitles.end())
    return {own, std::string(known->title), known->unit, std::string(known->help)};
  const ValueSpec* value = find_value(name).second;
  if (!value) return {own, own};
  return {own, value->title.empty() ? title_from(name) : std::string(value->title), value->unit,
          std::string(value->help), value->window};
}

std::vector<std::string> quantity_names() {
  std::vector<std::string> names = value_names();
  for (const Titled& known : kTitles) names.emplace_back(known.name);
  return names;
}

}  // namespace taut::report
