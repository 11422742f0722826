#include "experiments/history/history_answer.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "core/model/text.hpp"
#include "experiments/answer/number.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

using Kind = Changing::Kind;

constexpr std::size_t kMostRows = 12;  ///< rows shown to people unless they ask for all

/// "3f2a9c1d0e (2026-05-04)".
std::string dated(const Build& build) {
  return short_build(build.id) + " (" + build.made.substr(0, 10) + ")";
}

/// "2.1 to 2.6 %", with enough digits to distinguish the two numbers.
std::string from_to(const std::string& value, double before, double now) {
  const Unit unit = unit_of_value(value);
  const auto texts = [&](int digits) {
    return std::pair(number_text(before * unit.scale, digits),
                     number_text(now * unit.scale, digits));
  };
  auto [was, is] = texts(3);
  for (int digits = 4; was == is && digits <= 17; ++digits) std::tie(was, is) = texts(digits);
  return was + " to " + is + (unit.shown.empty() ? "" : " " + std::string(unit.shown));
}

const BuildRatio* ratio_of(const History& history, const HistoryStep& step) {
  return cost_step(history.ratios, history.rows[step.row].id, history.builds[step.before].id,
                   history.builds[step.now].id);
}

std::string what_happened(const History& history, const HistoryStep& step) {
  const std::string of = " of " + history.rows[step.row].id;
  if (step.what.kind == Kind::status)
    return "the status" + of + " went from " + status_change(history, step);
  if (const BuildRatio* ratio = step.what.is_cost() ? ratio_of(history, step) : nullptr)
    return std::string(step.what.kind == Kind::cpu ? "CPU time" : "wall time alone") + of +
           (step.is > 1 ? " rose to " : " fell to ") +
           interval_text({ratio->low, ratio->ratio, ratio->high}) + " times what it was";
  const std::string value = step.what.name();
  if (std::isnan(step.was) || std::isnan(step.is))
    return value + of + (std::isnan(step.is) ? " lost its meaning" : " got a meaning");
  return value + of + (step.is > step.was ? " rose from " : " fell from ") +
         from_to(value, step.was, step.is);
}

/// The build of a step. Builds just before it that have no result may be its cause as well.
std::string where(const History& history, const HistoryStep& step) {
  const std::size_t between = step.now - step.before - 1;
  return " at " + dated(history.builds[step.now]) +
         (between == 0
              ? ""
              : ", or at one of " + std::to_string(between) + " builds before it without a result");
}

Table table_of_steps(const History& history) {
  Table table{"steps",
              "",
              {{"step", "what changed"},
               {"cases"},
               {"relative", "largest change", kSignedShare},
               Column("build").in_detail(),
               Column("made").in_detail(),
               Column("subject").in_detail(),
               Column("before", "build before").in_detail(),
               Column("case").in_detail(),
               Column("solver").in_detail(),
               Column("value").in_detail(),
               Column("was").in_detail(),
               Column("is").in_detail()}};
  for (const SteppedValue& one : stepped_values(history)) {
    const HistoryStep& step = *one.largest;
    const HistoryRow& row = history.rows[step.row];
    const Build& build = history.builds[step.now];
    Cell sentence(one.sentence);
    if (row.points[step.now]) sentence.key = row.points[step.now]->key;
    table.rows.push_back({sentence, one.cases, step.relative, build.id, build.made, build.subject,
                          history.builds[step.before].id, row.id, row.solver, step.what.name(),
                          step.was, step.is});
  }
  table.most = kMostRows;
  return table;
}

Table table_of_builds(const History& history) {
  Table table{"builds",
              "builds",
              {{"build"},
               {"made"},
               {"subject"},
               {"cases"},
               {"shared", "shares with the build before"},
               {"steps"},
               {"gap"}},
              {},
              "Two builds share a result if nothing that it depends on changed between them."};
  for (std::size_t i = 0; i < history.builds.size(); ++i) {
    const Build& build = history.builds[i];
    const auto cases = std::ranges::count_if(
        history.rows, [&](const HistoryRow& row) { return row.points[i] != nullptr; });
    const auto steps = std::ranges::count(history.steps, i, &HistoryStep::now);
    const std::size_t missing = history.missing(i);
    std::string gap = build.gap;
    if (gap.empty() && missing > 0) gap = std::to_string(missing) + " cases without a result";
    table.rows.push_back({short_build(build.id), build.made.substr(0, 10), build.subject, cases,
                          history.shared(i), steps, gap});
  }
  table.detail = history.builds.size() > kMostRows;
  return table;
}

/// A row for each case: first value, last value and number of steps.
Table table_of_rows(const History& history, const std::string& value) {
  const Unit unit = unit_of_value(value);
  Table table{"rows",
              value + " of each case",
              {{"case"}, {"first", "first", unit}, {"last", "last", unit}, {"builds"}, {"steps"}}};
  for (std::size_t r = 0; r < history.rows.size(); ++r) {
    const HistoryRow& row = history.rows[r];
    Cell first, last;
    std::size_t builds = 0;
    for (const auto& point : row.points) {
      if (!point) continue;
      ++builds;
      const auto at = point->values.find(value);
      Cell cell = at != point->values.end()
                      ? Cell(at->second)
                      : Cell::lacking(Cell::State::none, describe(point->status));
      cell.key = point->key;
      if (builds == 1) first = cell;
      last = cell;
    }
    const auto steps = std::ranges::count_if(history.steps, [&](const HistoryStep& step) {
      return step.row == r && (step.what == changing(value) || step.what.kind == Kind::status);
    });
    table.rows.push_back({row.id, first, last, builds, steps});
  }
  table.most = 2 * kMostRows;
  return table;
}

/// A value of all cases over all builds, as data.
Table table_of_values(const History& history, const std::string& value) {
  Table table{
      "values",
      "",
      {{"build"}, {"made"}, {"case"}, {"value", value, unit_of_value(value), 6}, {"status"}}};
  for (std::size_t i = 0; i < history.builds.size(); ++i)
    for (const HistoryRow& row : history.rows)
      if (const auto& point = row.points[i]) {
        const auto at = point->values.find(value);
        table.rows.push_back({history.builds[i].id, history.builds[i].made, row.id,
                              at == point->values.end() ? Cell() : Cell(at->second),
                              describe(point->status)});
      }
  table.detail = true;
  return table;
}

/// Cost ratios of pairs of builds that were timed in turns.
Table table_of_ratios(const History& history) {
  Table table{
      "ratios", "", {{"case"}, {"before"}, {"now"}, {"host"}, {"clock"}, {"ratio"}, {"control"}}};
  for (const BuildRatio& one : history.ratios)
    table.rows.push_back({one.id, one.before, one.now, one.host, one.clock,
                          Interval{one.low, one.ratio, one.high},
                          Interval{one.control_low, one.control, one.control_high}});
  table.detail = true;
  return table;
}

}  // namespace

std::string short_build(const std::string& id) {
  const bool commit = id.size() == 40 && id.find_first_not_of("0123456789abcdef") == id.npos;
  return commit ? id.substr(0, 10) : id;
}

std::string status_change(const History& history, const HistoryStep& step) {
  const auto& points = history.rows[step.row].points;
  return describe(points[step.before]->status) + " to " + describe(points[step.now]->status);
}

std::vector<SteppedValue> stepped_values(const History& history) {
  std::set<std::string_view> roles;
  for (const ValueSpec* value : values_with_role()) roles.insert(value->name);
  std::vector<SteppedValue> all;
  std::map<std::tuple<std::size_t, Changing, std::string>, std::size_t> place;
  for (const HistoryStep& step : history.steps) {
    const auto [at, fresh] =
        place.try_emplace({step.now, step.what, history.rows[step.row].solver}, all.size());
    if (fresh) all.push_back({&step, 0, ""});
    ++all[at->second].cases;
  }
  for (SteppedValue& one : all) {
    one.sentence = what_happened(history, *one.largest) + where(history, *one.largest);
    if (one.cases > 1)
      one.sentence += "; and of " + std::to_string(one.cases - 1) +
                      (one.cases == 2 ? " other case" : " other cases");
  }
  // order: statuses, costs, values that answer a question, other values
  std::ranges::stable_sort(all, {}, [&](const SteppedValue& one) {
    const Changing& what = one.largest->what;
    switch (what.kind) {
      case Kind::status:
        return 0;
      case Kind::cpu:
      case Kind::wall:
        return 1;
      case Kind::value:
        break;
    }
    return roles.contains(what.metric) ? 2 : 3;
  });
  return all;
}

Answer answer_of(const History& history, const std::string& value) {
  Answer answer{"history", history.study};
  std::size_t gaps = 0;
  for (std::size_t i = 0; i < history.builds.size(); ++i)
    gaps += history.is_gap(i) || history.missing(i) > 0;
  const auto values = std::ranges::count_if(
      history.steps, [](const HistoryStep& step) { return !step.what.is_cost(); });
  answer.add({"builds"}, history.builds.size());
  answer.add({"gaps", "builds that lack results"}, gaps);
  answer.add({"cases"}, history.rows.size());
  answer.add({"compared", "pairs of neighbouring results"}, history.compared);
  answer.add({"steps", "steps of values and costs"}, history.steps.size());
  answer.add(Column("value_steps").in_detail(), values);
  answer.add({"last_stepped", "the last build differs from the one before"},
             history.last_stepped());
  answer.add(table_of_steps(history));
  answer.add(table_of_builds(history));
  answer.add(table_of_rows(history, value));
  answer.add(table_of_values(history, value));
  answer.add(table_of_ratios(history));
  return answer;
}

std::string junit(const History& history) {
  std::size_t last = 0;
  for (std::size_t i = 0; i < history.builds.size(); ++i)
    for (const HistoryRow& row : history.rows)
      if (row.points[i]) last = i;
  Baseline now;
  Comparison comparison;
  for (std::size_t r = 0; r < history.rows.size(); ++r) {
    const HistoryRow& row = history.rows[r];
    if (row.keys[last].empty()) continue;
    now.push_back({.id = row.id, .spec = {}, .scene = row.scene, .status = {}, .values = {}});
    if (!row.points[last])
      comparison.findings.push_back(
          {Change::Kind::case_missing, row.id, row.solver, "the last build has no result of it"});
  }
  for (const HistoryStep& step : history.steps)
    if (step.now == last)
      comparison.findings.push_back({Change::Kind::value_moved, history.rows[step.row].id,
                                     history.rows[step.row].solver,
                                     what_happened(history, step) + where(history, step)});
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n" +
         junit("history of " + history.study, now, comparison) + "</testsuites>\n";
}

}  // namespace taut
