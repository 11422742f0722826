// Tables of what scenes require and how far solvers go, of what differs between two folders, and of
// what Vasilovici's report asserts.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/model/parts.hpp"
#include "experiments/system/distinct.hpp"
#include "experiments/truths/assertions/assertions.hpp"

namespace taut::report {

void add_by_id(Json& part, const char* list, Json one, Json& all) {
  part[list].push_back(one["id"]);
  all.push_back(std::move(one));
}

void add_table(Json& part, Table table, Answer& tables) {
  if (table.rows.empty()) return;
  part["tables"].push_back(table.name);
  tables.add(std::move(table));
}

Json json_of_tables(const Answer& answer) { return parse_json(to_json(answer))["tables"]; }

namespace {

std::string limit_text(double value, const ParameterFrontier& one) {
  return significant(value, 3) + (one.unit.empty() ? "" : "\u00A0" + one.unit);
}

std::string end_text(const ParameterFrontier& one) {
  if (!one.lacks.empty()) return "–: " + one.lacks;
  if (std::isnan(one.bad)) return limit_text(one.to, one) + ", as far as was asked";
  return (std::isnan(one.good) ? "none" : limit_text(one.good, one)) + ", then " + one.symptom +
         (std::isnan(one.theory) ? "" : " (theory: " + limit_text(one.theory, one) + ")");
}

Table frontier_table(const std::vector<ParameterFrontier>& frontiers) {
  std::vector<std::string> solvers, parameters;
  for (const ParameterFrontier& f : frontiers)
    push_unique(solvers, f.solver), push_unique(parameters, f.parameter);
  Table table{"frontiers",
              "How far every parameter goes on a small swinging sheet",
              {Column("parameter")},
              {},
              "The hardest setting up to which nothing was wrong, and what goes wrong first beyond "
              "it, by its own metric; taut frontier --all."};
  for (const std::string& solver : solvers) table.columns.emplace_back(solver, solver);
  for (const std::string& parameter : parameters) {
    std::vector<Cell> row{parameter};
    for (const std::string& solver : solvers) {
      const auto at = std::ranges::find_if(
          frontiers, [&](const auto& f) { return f.parameter == parameter && f.solver == solver; });
      row.push_back(at == frontiers.end() ? Cell() : Cell(end_text(*at)));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

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

Json json_of_limits(const ReportInput& input, Answer& tables) {
  Json limits;
  Table table{"required",
              "The smallest model that keeps a scene's answers",
              {},
              {},
              "taut require takes away or coarsens one effect at a time and then all that can go; "
              "an answer may move by its tolerance, or by what a rounding error at the start moves "
              "it. Of a chaotic scene only statistics are kept."};
  for (const char* name :
       {"scene", "solver", "chaotic", "kept answers", "can go", "required", "CPU time left"})
    table.columns.emplace_back(name);
  for (const Json& row : input.required) {
    auto& cells = table.rows.emplace_back();
    for (const Json& cell : row) cells.emplace_back(cell.get<std::string>());
  }
  add_table(limits, std::move(table), tables);
  add_table(limits, frontier_table(input.frontiers), tables);
  return limits;
}

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

Table assertions_table(const std::optional<Truths>& truths) {
  Table table{"assertions", "What publications assert", {}};
  for (const char* name : {"source", "assertion", "verdict", "because", "measured"})
    table.columns.emplace_back(name);
  for (const Assertion& assertion : assertions()) {
    std::vector<Cell> row{std::string(assertion.source) + ", " + std::string(assertion.place),
                          typeset(assertion.assertion),
                          to_string(assertion.verdict),
                          typeset(assertion.because),
                          {}};
    if (truths)
      if (const auto now = truths->assertions.find(std::string(assertion.assertion));
          now != truths->assertions.end())
        row[2] = now->second.first, row[4] = typeset(now->second.second);
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<std::string> limits_of(const ReportInput& input, const CaseList& refs) {
  std::set<double> steps, sweeps, substeps, ends;
  std::vector<std::string> scenes;
  for (const Record* r : refs.cases()) {
    push_unique(scenes, r->scene);
    steps.insert(r->dt), ends.insert(std::round(r->steps * r->dt * 100) / 100);
    if (const Work work = work_of(*r); work.sweeps > 0)
      sweeps.insert(work.sweeps), substeps.insert(work.substeps);
  }
  const auto range = [](const std::set<double>& values, const char* name) {
    return range_text(values, quantity(name));
  };
  std::vector<std::string> points{
      "Other scenes than " + joined(scenes) + ", simulated for " + range(ends, "t") + ".",
      "Other time steps than " + range(steps, "dt") +
          (sweeps.empty() ? ""
                          : ", other work than " + range(substeps, kSubsteps) + " substeps of " +
                                range(sweeps, kSweeps) + " sweeps") +
          "; not each was run with each."};
  points.push_back(input.bench
                       ? "Cost on another machine than " + input.bench->machine +
                             ", or at settings between those timed (taut advise searches them)."
                       : "Cost: no CPU time was measured; equal sweeps are equal work, not equal "
                         "time.");
  std::map<std::string, std::vector<std::string>> computing;  // by arithmetic
  std::set<std::string> shown;
  for (const Record* r : refs.cases()) {
    shown.insert(r->solver);
    push_unique(computing[arithmetic(*r, input.vectors)], solver_title(r->solver));
  }
  if (computing.size() > 1)
    points.push_back(
        "Equal arithmetic: links are computed in " +
        join(computing, "; in ",
             [](const auto& one) { return one.first + " by " + joined(one.second); }) +
        ". CPU times compare programs, not algorithms (simd=scalar and precision=double "
        "make Jakobsen and XPBD alike).");
  std::vector<std::string> absent;
  for (const SolverEntry* entry : solvers())
    if (!shown.contains(std::string(entry->name))) absent.push_back(solver_title(entry->name));
  if (!absent.empty())
    points.push_back(
        "Solvers that were not run here: " + joined(absent) + "." +
        (shown.contains("implicit")
             ? ""
             : " Implicit Euler is not among the main job's solvers: each of its iterations "
               "factors the "
               "whole system anew, so that 16 of them are equal work to nothing here; its "
               "converged "
               "step is what Projective Dynamics and VBD approach (Inside one step), and taut run "
               "elastic compares it where links are elastic."));
  points.emplace_back(
      "Real cloth: errors are distances from constraints, a reference or a closed form, not from a "
      "measured fabric.");
  std::size_t records = 0, planned = 0;
  for (const StudyResult& study : input.studies)
    records += study.records.size(), planned += std::max(study.planned, study.records.size());
  if (records < planned)
    points.push_back("The " + std::to_string(planned - records) +
                     " planned cases that have not been run.");
  return points;
}

}  // namespace taut::report
