// What differs between two results folders.
#include <algorithm>
#include <cmath>
#include <map>

#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/wording.hpp"
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
std::vector<Cell> row_of(const Changed& changed, CaseList& refs) {
  const auto& [a, b] = *changed.pair;
  Cell head(b.scene + " " + solver_title(b.solver) + " " + brief_settings(b.spec.solver) + ", " +
            quantity("dt").text(b.dt, 3));
  head.key = refs.key(b);
  if (!changed.value)
    return {head, "status", to_string(a.status.kind), to_string(b.status.kind), {}, {}};
  const Quantity& q = refs.use(*changed.value);
  const double before = a.values.at(*changed.value), now = b.values.at(*changed.value);
  return {head,
          q.title,
          q.text(before, 4),
          q.text(now, 4),
          before == 0 ? Cell() : Cell(now / before - 1),
          !q.unit.less_is_better ? Cell()
          : now < before         ? Cell("better")
                                 : Cell("worse")};
}

/// How cases end, pair by pair.
Table ends_table(const Differences& differences) {
  Table table{"differences-ends",
              "How cases end",
              {Column("in_a", "in A"), Column("in_b", "in B"), Column("cases", "cases", kCount)},
              {},
              std::to_string(differences.pairs.size()) + " cases in both; in A alone " +
                  std::to_string(differences.only_a) + ", in B alone " +
                  std::to_string(differences.only_b)};
  std::map<std::pair<std::string_view, std::string_view>, int> ends;
  for (const auto& [a, b] : differences.pairs)
    ++ends[{to_string(a.status.kind), to_string(b.status.kind)}];
  for (const auto& [how, n] : ends) table.rows.push_back({how.first, how.second, n});
  return table;
}

/// Values with a role: in how many cases they are less or more in B.
Table compared_table(const Differences& differences, CaseList& refs) {
  Table table{
      "differences",
      "What differs, value by value",
      {Column("value"), Column("cases", "cases", kCount), Column("less", "less in B", kCount),
       Column("more", "more in B", kCount), Column("change", "largest change", kSignedShare)},
      {},
      "Of cases that completed in both; the largest change is over the larger of the two."};
  for (const ValueSpec* value : values_with_role()) {
    const std::string name(value->name);
    int cases = 0, less = 0, more = 0;
    Cell largest;
    for (const auto& [a, b] : differences.pairs) {
      const double before = completed(a.status) ? value_of(a, name) : std::nan(""),
                   now = completed(b.status) ? value_of(b, name) : std::nan("");
      if (!std::isfinite(before) || !std::isfinite(now)) continue;
      ++cases, less += now<before, more += now> before;
      const double change =
          now == before ? 0 : (now - before) / std::max(std::abs(now), std::abs(before));
      if (!largest.empty() && std::abs(change) <= std::abs(largest.number())) continue;
      largest = Cell(change), largest.key = refs.key(b);
    }
    if (cases > 0) table.rows.push_back({refs.use(name).title, cases, less, more, largest});
  }
  return table;
}

/// What B costs over A; each was timed in a session of its own, so nothing is clear.
Table costs_table(const Differences& differences) {
  Table table{"differences-cost",
              "CPU time of B over that of A",
              {Column("solver"), Column("cases", "cases", kCount), Column("ratio", "B over A"),
               Column("sure", "how sure")},
              {},
              "Geometric mean of cases of the same scene, solver and settings, in sessions of "
              "their own; identical code differed by up to " +
                  shown(kShare, differences.noise)};
  std::map<std::string, std::vector<Interval>> ratios;
  for (const auto& [a, b] : differences.timed)
    if (a.stable() && b.stable()) {
      const double ratio = b.cost().mid / a.cost().mid;
      ratios[a.record.solver].push_back({ratio, ratio, ratio});
    }
  const double noise = differences.noise;
  for (const auto& [solver, all] : ratios) {
    const Interval mean = geometric_mean(all);
    const Certainty sure =
        std::max(judge(mean, {1 / (1 + noise), 1, 1 + noise}), Certainty::likely);
    table.rows.push_back({solver_title(solver), all.size(), mean.mid, to_string(sure)});
  }
  return table;
}

}  // namespace

Json json_of(const Differences& differences, CaseList& refs, Answer& tables) {
  Json one{
      {"a", differences.a},
      {"b", differences.b},
      {"matched",
       "Cases are matched by the names of scene and solver and by their settings, not by what is "
       "in a scene's file: one that was changed between A and B differs here as a solver does."}};
  add_table(one, ends_table(differences), tables);
  add_table(one, compared_table(differences, refs), tables);
  add_table(one, costs_table(differences), tables);
  const std::vector<Changed> changed = all_changed(differences);
  const std::size_t rows = std::min(changed.size(), kMostRows);
  Table table{"differences-values",
              "Values that differ",
              {Column("case"), Column("value"), Column("A"), Column("B"),
               Column("change", "change", kSignedShare), Column("judged")},
              {},
              "The " + std::to_string(rows) + " largest relative changes of " +
                  std::to_string(changed.size()) + "; better and worse where a value is an error."};
  for (std::size_t i = 0; i < rows; ++i) table.rows.push_back(row_of(changed[i], refs));
  add_table(one, std::move(table), tables);
  return one;
}

}  // namespace taut::report
