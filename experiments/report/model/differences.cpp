// Differences between two results folders.
#include <algorithm>
#include <cmath>
#include <map>

#include "experiments/case/comparison.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/model/parts.hpp"
#include "experiments/report/questions/rows.hpp"

namespace taut::report {

namespace {

constexpr std::size_t kMostRows = 200;  ///< rows shown in the table; the data contain all

/// A case that both folders have. If it completed in both, includes the values that are numbers in
/// both.
struct ComparedCase {
  const std::pair<Record, Record>* pair;
  std::vector<ComparedValue> values;
};

std::vector<ComparedCase> compared_cases(const Differences& differences) {
  std::vector<ComparedCase> all;
  for (const auto& pair : differences.pairs) {
    const auto& [a, b] = pair;
    all.push_back({&pair, {}});
    if (!completed(a.status) || !completed(b.status)) continue;
    all.back().values = compare_values(a.values, b.values, Tolerances::exact());
    std::erase_if(all.back().values, [](const ComparedValue& one) { return !one.both_finite(); });
  }
  return all;
}

/// A value or status of a case that differs in B.
struct Changed {
  const std::pair<Record, Record>* pair;
  const ComparedValue* value;  ///< nullptr: the status differs
  double size;                 ///< |b - a| over the larger of the two; 2: the status differs
};

/// All changes, the largest first.
std::vector<Changed> all_changed(const std::vector<ComparedCase>& cases) {
  std::vector<Changed> all;
  for (const ComparedCase& one : cases) {
    const auto& [a, b] = *one.pair;
    if (a.status.kind != b.status.kind) {
      all.push_back({one.pair, nullptr, 2});
      continue;
    }
    for (const ComparedValue& value : one.values)
      if (value.kind == ComparedValue::Kind::moved)
        all.push_back({one.pair, &value, std::abs(mutual_change(value.before, value.now))});
  }
  std::ranges::stable_sort(all, [](const Changed& x, const Changed& y) { return x.size > y.size; });
  return all;
}

/// Row of a change: the case, its value in A and in B, the change, and whether that is better.
std::vector<Cell> row_of(const Changed& changed, CaseList& refs) {
  const auto& [a, b] = *changed.pair;
  Cell head(b.scene + " " + titled(b.solver, brief_settings(b)) + ", " +
            quantity("dt").text(b.dt, 3));
  head.key = refs.key(b);
  if (!changed.value)
    return {head, "status", to_string(a.status.kind), to_string(b.status.kind), {}, {}};
  const Quantity& q = refs.use(changed.value->value);
  const double before = changed.value->before, now = changed.value->now;
  return {head,
          q.title,
          q.text(before, 4),
          q.text(now, 4),
          before == 0 ? Cell() : Cell(now / before - 1),
          !q.unit.less_is_better ? Cell()
          : now < before         ? Cell("better")
                                 : Cell("worse")};
}

/// A table of how cases end in A and in B.
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

/// Counts the cases in which a value is less or more in B.
class Counted {
 public:
  void add(double before, double now, const std::string& key) {
    ++cases_;
    less_ += now < before;
    more_ += now > before;
    const double change = mutual_change(before, now);
    if (!largest_.empty() && std::abs(change) <= std::abs(largest_.number())) return;
    largest_ = Cell(change);
    largest_.key = key;
  }
  bool any() const { return cases_ > 0; }
  std::vector<Cell> row(Cell title) const { return {title, cases_, less_, more_, largest_}; }

 private:
  int cases_ = 0, less_ = 0, more_ = 0;
  Cell largest_;
};

/// A table of the values with a role and of the cost of a step.
Table compared_table(const Differences& differences, const std::vector<ComparedCase>& cases,
                     CaseList& refs) {
  Table table{
      "differences",
      "What differs, value by value",
      {Column("value"), Column("cases", "cases", kCount), Column("less", "less in B", kCount),
       Column("more", "more in B", kCount), Column("change", "largest change", kSignedShare)},
      {},
      "Of cases that completed in both; the largest change is over the larger of the two."};
  std::map<std::string, Counted> by_value;
  for (const ComparedCase& one : cases)
    for (const ComparedValue& value : one.values)
      by_value[value.value].add(value.before, value.now, refs.key(one.pair->second));
  for (const ValueSpec* value : values_with_role())
    if (const auto at = by_value.find(std::string(value->name)); at != by_value.end())
      table.rows.push_back(at->second.row(refs.use(at->first).title));
  Counted cpu;
  for (const auto& [a, b] : differences.timed)
    if (a.stable() && b.stable())
      cpu.add(a.cost().mid * a.record.dt, b.cost().mid * b.record.dt, refs.key(b.record));
  if (cpu.any())
    table.rows.push_back(cpu.row(Cell("CPU time of a step")
                                     .with("not timed together: identical code differs, too; taut "
                                           "bench --against times two builds in turns")));
  return table;
}

/// A table of the cost of B relative to A. Each was timed in its own session, so no difference
/// counts as clear.
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
  Json one{{"a", differences.a},
           {"b", differences.b},
           {"matched",
            "Cases are matched by the names of scene and solver and by their settings, not by the "
            "content of a scene's file: a change of that file between A and B shows like one of a "
            "solver."}};
  add_table(one, ends_table(differences), tables);
  const std::vector<ComparedCase> cases = compared_cases(differences);
  add_table(one, compared_table(differences, cases, refs), tables);
  add_table(one, costs_table(differences), tables);
  const std::vector<Changed> changed = all_changed(cases);
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
