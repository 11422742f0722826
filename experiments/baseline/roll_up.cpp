#include "experiments/baseline/roll_up.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

namespace taut {

namespace {

double relative_change(const Change& c) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const double share = c.before == 0 ? kNone : (c.now - c.before) / std::abs(c.before);
  return std::isfinite(share) ? share : kNone;
}

}  // namespace

double MovedValue::relative() const { return relative_change(*largest); }

std::vector<MovedValue> roll_up(const Comparison& comparison) {
  std::map<std::pair<std::string, std::string>, MovedValue> groups;
  for (const Change& c : comparison.findings) {
    if (!c.is_regression()) continue;
    MovedValue& group = groups[{c.scene, c.value}];
    group.scene = c.scene, group.value = c.value;
    ++group.cases, group.less += c.now<c.before, group.more += c.now> c.before;
    if (!group.largest || std::abs(relative_change(c)) > std::abs(group.relative()))
      group.largest = &c;
  }
  std::vector<MovedValue> all;
  for (const auto& [name, group] : groups) all.push_back(group);
  std::ranges::stable_sort(all, [](const MovedValue& a, const MovedValue& b) {
    return std::abs(a.relative()) > std::abs(b.relative());
  });
  return all;
}

std::string text(const MovedValue& moved, std::string_view unit) {
  if (moved.largest->kind == Change::Kind::status_changed) return moved.largest->text;
  char text[160];
  const std::string of(unit == "1" || unit.empty() ? "" : " " + std::string(unit));
  if (std::isfinite(moved.relative()))
    std::snprintf(text, sizeof text, "%+.3g %% (%.4g -> %.4g%s)", 100 * moved.relative(),
                  moved.largest->before, moved.largest->now, of.c_str());
  else
    std::snprintf(text, sizeof text, "%.4g -> %.4g%s", moved.largest->before, moved.largest->now,
                  of.c_str());
  return text;
}

}  // namespace taut
