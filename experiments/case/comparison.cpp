#include "experiments/case/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {

bool Tolerance::holds(double value, double before) const {
  if (std::isnan(value) || std::isnan(before)) return std::isnan(value) == std::isnan(before);
  if (value == before) return true;  // infinities too
  return std::abs(value - before) <= absolute + relative * std::abs(before);
}

Tolerances Tolerances::exact() {
  return Tolerances({{"default", {0, 0, false, "every bit counts"}}});
}

const Tolerance& Tolerances::of(const std::string& value) const {
  static const Tolerance kBuiltIn{1e-12, 1e-6, false, "deterministic"};
  std::string name = value;
  while (true) {
    if (const auto found = by_name_.find(name); found != by_name_.end()) return found->second;
    const auto dot = name.rfind('.');
    if (dot == name.npos) break;
    name.resize(dot);
  }
  const auto other = by_name_.find("default");
  return other != by_name_.end() ? other->second : kBuiltIn;
}

bool ComparedValue::both_finite() const { return std::isfinite(before) && std::isfinite(now); }

std::vector<ComparedValue> compare_values(const MetricValues& before, const MetricValues& now,
                                          const Tolerances& tolerances) {
  using Kind = ComparedValue::Kind;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<ComparedValue> all;
  for (const auto& [name, was] : before) {
    const Tolerance& tolerance = tolerances.of(name);
    if (tolerance.ignored) continue;
    const auto is = now.find(name);
    if (is == now.end())
      all.push_back({name, was, kNone, Kind::lost});
    else
      all.push_back(
          {name, was, is->second, tolerance.holds(is->second, was) ? Kind::same : Kind::moved});
  }
  for (const auto& [name, is] : now)
    if (!before.contains(name) && !tolerances.of(name).ignored)
      all.push_back({name, kNone, is, Kind::gained});
  return all;
}

double relative_change(double before, double now) {
  constexpr double kFromZero = std::numeric_limits<double>::infinity();
  const double share = before == 0 ? kFromZero : (now - before) / std::abs(before);
  return std::isfinite(share) ? share : kFromZero;
}

double mutual_change(double before, double now) {
  return now == before ? 0 : (now - before) / std::max(std::abs(now), std::abs(before));
}

}  // namespace taut
