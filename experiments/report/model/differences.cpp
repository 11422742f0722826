#include <algorithm>
#include <cmath>

#include "experiments/case/record_io.hpp"
#include "experiments/report/chart/format.hpp"
#include "experiments/report/chart/settings.hpp"
#include "experiments/report/model/parts.hpp"

namespace taut::report {

namespace {

constexpr std::size_t kMostRows = 200;  ///< of the table; the data has all

/// A value of a case that B has otherwise.
struct Changed {
  const std::pair<Record, Record>* pair;
  const std::string* value;  ///< nullptr: the status
  double size;               ///< |b - a| over the larger; 2: another status
};

/// The largest first.
std::vector<Changed> all_changed(const Differences& differences) {
  std::vector<Changed> all;
  for (const auto& pair : differences.pairs) {
    const auto& [a, b] = pair;
    if (a.status.kind != b.status.kind) {
      all.push_back({&pair, nullptr, 2});
      continue;
    }
    if (!completed(b.status)) continue;
    for (const auto& [name, now] : b.values) {
      const auto at = a.values.find(name);
      if (at == a.values.end() || !std::isfinite(now) || !std::isfinite(at->second)) continue;
      const double before = at->second;
      if (now != before)
        all.push_back(
            {&pair, &name, std::abs(now - before) / std::max(std::abs(now), std::abs(before))});
    }
  }
  std::ranges::stable_sort(all, [](const Changed& x, const Changed& y) { return x.size > y.size; });
  return all;
}

/// Its row: what it is, in A, in B, the change, and whether that is better.
Json row_of(const Changed& changed, References& refs) {
  const auto& [a, b] = *changed.pair;
  Json head{{"text", b.scene + " " + solver_title(b.solver) + " " + brief_settings(b.spec.solver) +
                         ", " + quantity("dt").text(b.dt, 3)}};
  add_if(head, "case", refs.key(b));
  if (!changed.value)
    return {head, "status", to_string(a.status.kind), to_string(b.status.kind), "–", ""};
  const Quantity& q = refs.use(*changed.value);
  const double before = a.values.at(*changed.value), now = b.values.at(*changed.value);
  return {head,
          q.title,
          q.text(before, 4),
          q.text(now, 4),
          before == 0 ? "–" : significant(100 * (now / before - 1), 2) + "\u00A0%",
          !q.less_is_better ? ""
          : now < before    ? "better"
                            : "worse"};
}

}  // namespace

Json json_of(const Differences& differences, References& refs, Json& tables) {
  const std::vector<Changed> changed = all_changed(differences);
  Json one{{"a", differences.a}, {"b", differences.b}};
  if (changed.empty()) return one;
  const std::size_t rows = std::min(changed.size(), kMostRows);
  Json table{{"id", "differences-values"},
             {"title", "Values that differ"},
             {"caption", "The " + std::to_string(rows) + " largest relative changes of " +
                             std::to_string(changed.size()) +
                             "; better and worse where a value is an error."},
             {"columns", Json::array()},
             {"rows", Json::array()}};
  for (const char* title : {"case", "value", "A", "B", "change", "judged"})
    table["columns"].push_back({{"title", title}});
  for (std::size_t i = 0; i < rows; ++i) table["rows"].push_back(row_of(changed[i], refs));
  one["tables"].push_back(table["id"]);
  tables.push_back(std::move(table));
  return one;
}

}  // namespace taut::report
