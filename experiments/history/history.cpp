#include "experiments/history/history.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "experiments/case/record_io.hpp"
#include "experiments/results/database.hpp"
#include "experiments/results/store.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut {

namespace {

using Kind = Changing::Kind;

constexpr std::size_t kNone = std::string::npos;

/// Names of changes that are not of a metric's value; costs have the names that `taut bench` uses.
constexpr std::pair<Kind, std::string_view> kNamed[] = {
    {Kind::status, "status"}, {Kind::cpu, "cpu.per_step"}, {Kind::wall, "wall.per_step"}};

/// The kind of cost of a stored ratio.
Kind kind_of(const BuildRatio& ratio) { return ratio.clock == "cpu" ? Kind::cpu : Kind::wall; }

MetricValues values_of(Database& database, std::int64_t case_id,
                       const std::map<std::int64_t, std::string>& names) {
  MetricValues values;
  Database::Rows value =
      database.rows("SELECT metric_id, value FROM numbers WHERE case_id = ?", case_id);
  while (value.next()) values[names.at(value.integer(0))] = value.number(1);
  return values;
}

/// Reads the rows of a study. Each distinct result becomes one point.
void read_rows(Database& database, History& history) {
  std::map<std::int64_t, std::string> names;
  {
    Database::Rows metric = database.rows("SELECT metric_id, name FROM metrics");
    while (metric.next()) names[metric.integer(0)] = metric.text(1);
  }
  std::map<std::string, std::size_t> place;
  for (std::size_t i = 0; i < history.builds.size(); ++i) place[history.builds[i].id] = i;
  std::map<std::string, std::shared_ptr<const HistoryPoint>> known;  // of one row, by digest
  Database::Rows one = database.rows(
      "SELECT ran.id, build, ran.key, case_id, result_digest, status, reason, scene, solver FROM "
      "ran "
      "LEFT JOIN cases ON cases.key = ran.key WHERE study = ? ORDER BY ran.id",
      history.study);
  while (one.next()) {
    const auto at = place.find(one.text(1));
    if (at == place.end()) continue;
    if (history.rows.empty() || history.rows.back().id != one.text(0)) {
      HistoryRow row{one.text(0), "", "", {}, {}};
      row.points.resize(history.builds.size());
      row.keys.resize(history.builds.size());
      history.rows.push_back(std::move(row));
      known.clear();
    }
    HistoryRow& row = history.rows.back();
    row.keys[at->second] = one.text(2);
    if (one.null(3)) continue;
    row.scene = one.text(7);
    row.solver = one.text(8);
    std::shared_ptr<const HistoryPoint>& point = known[one.text(4)];
    if (!point) {
      HistoryPoint fresh{
          one.text(2), {status_kind(one.text(5)), StatusReason::stored(one.text(6))}, {}};
      if (completed(fresh.status)) fresh.values = values_of(database, one.integer(3), names);
      point = std::make_shared<const HistoryPoint>(std::move(fresh));
    }
    row.points[at->second] = point;
  }
}

void add_value_steps(History& history, const Tolerances& tolerances) {
  for (std::size_t r = 0; r < history.rows.size(); ++r) {
    const HistoryRow& row = history.rows[r];
    std::size_t before = kNone;
    for (std::size_t now = 0; now < row.points.size(); ++now) {
      if (!row.points[now]) continue;
      const std::size_t was = std::exchange(before, now);
      if (was == kNone) continue;
      ++history.compared;
      if (row.points[was] == row.points[now]) continue;
      const HistoryPoint &a = *row.points[was], &b = *row.points[now];
      if (!ended_alike(a, b))
        history.steps.push_back(
            {r, was, now, {Kind::status}, 0, 0, std::numeric_limits<double>::infinity()});
      if (!completed(a.status) || !completed(b.status)) continue;
      for (const ComparedValue& one : compare_values(a.values, b.values, tolerances))
        if (one.kind == ComparedValue::Kind::moved)
          history.steps.push_back({r,
                                   was,
                                   now,
                                   {Kind::value, one.value},
                                   one.before,
                                   one.now,
                                   relative_change(one.before, one.now)});
    }
  }
}

std::size_t row_of(const History& history, const std::string& id) {
  const auto at = std::ranges::lower_bound(history.rows, id, {}, &HistoryRow::id);
  return at != history.rows.end() && at->id == id
             ? static_cast<std::size_t>(at - history.rows.begin())
             : kNone;
}

std::size_t build_of(const History& history, const std::string& id) {
  const auto at = std::ranges::find(history.builds, id, &Build::id);
  return at == history.builds.end() ? kNone : static_cast<std::size_t>(at - history.builds.begin());
}

/// Whether no build between the two has a result for the case. A bisection also times builds that
/// are not neighbours.
bool are_neighbours(const HistoryRow& row, std::size_t before, std::size_t now) {
  for (std::size_t i = before + 1; i < now; ++i)
    if (row.points[i]) return false;
  return before < now;
}

/// Adds the steps in cost between neighbours that were timed in turns.
void add_cost_steps(History& history) {
  for (const BuildRatio& one : history.ratios) {
    const std::size_t row = row_of(history, one.id), before = build_of(history, one.before),
                      now = build_of(history, one.now);
    if (row == kNone || before == kNone || now == kNone) continue;
    if (!are_neighbours(history.rows[row], before, now)) continue;
    ++history.compared;
    if (cost_step(history.ratios, one.id, one.before, one.now) == &one)
      history.steps.push_back({row, before, now, {kind_of(one)}, 1, one.ratio, one.ratio - 1});
  }
}

/// Removes the steps that involve a result that does not match its digest.
void leave_out_unsound(const Store& store, History& history) {
  std::map<std::string, bool> sound;
  const auto is_sound = [&](const std::string& key) {
    const auto at = sound.find(key);
    if (at != sound.end()) return at->second;
    return sound[key] = store.find(key).has_value();
  };
  std::erase_if(history.steps, [&](const HistoryStep& step) {
    const HistoryRow& row = history.rows[step.row];
    return !step.what.is_cost() &&
           (!is_sound(row.points[step.before]->key) || !is_sound(row.points[step.now]->key));
  });
}

}  // namespace

bool ended_alike(const HistoryPoint& a, const HistoryPoint& b) {
  return a.status.kind == b.status.kind && a.status.reason.text() == b.status.reason.text();
}

std::string Changing::name() const {
  const auto at = std::ranges::find(kNamed, kind, &std::pair<Kind, std::string_view>::first);
  return at == std::end(kNamed) ? metric : std::string(at->second);
}

Changing changing(std::string_view name) {
  for (const auto& [kind, text] : kNamed)
    if (text == name) return {kind};
  return {Kind::value, std::string(name)};
}

const BuildRatio* cost_step(const std::vector<BuildRatio>& all, const std::string& id,
                            const std::string& before, const std::string& now) {
  const BuildRatio* found = nullptr;
  for (const BuildRatio& one : all) {
    if (one.id != id || one.before != before || one.now != now) continue;
    const bool differs = beyond_both({one.low, one.ratio, one.high},
                                     {one.control_low, one.control, one.control_high});
    if (differs && (!found || kind_of(one) == Kind::cpu)) found = &one;
  }
  return found;
}

std::size_t History::missing(std::size_t build) const {
  return static_cast<std::size_t>(std::ranges::count_if(rows, [&](const HistoryRow& row) {
    if (!row.keys[build].empty()) return !row.points[build];
    return build > 0 && build + 1 == builds.size() && !row.keys[build - 1].empty();
  }));
}

std::size_t History::shared(std::size_t build) const {
  if (build == 0) return 0;
  return static_cast<std::size_t>(std::ranges::count_if(rows, [&](const HistoryRow& row) {
    return !row.keys[build].empty() && row.keys[build] == row.keys[build - 1];
  }));
}

bool History::last_stepped() const {
  std::size_t last = 0;
  for (const HistoryRow& row : rows)
    for (std::size_t build = row.points.size(); build-- > last;)
      if (row.points[build]) last = build;
  return std::ranges::any_of(steps, [&](const HistoryStep& step) { return step.now == last; });
}

History history_of(const Store& store, const std::string& study, const Tolerances& tolerances,
                   const std::vector<Build>& builds) {
  History history{study, builds, {}, {}, {}, 0};
  if (builds.empty()) history.builds = builds_of(store, study);
  Database* database = store.reading();
  if (!database) return history;
  read_rows(*database, history);
  history.ratios = ratios_of(store, study);
  add_value_steps(history, tolerances);
  add_cost_steps(history);
  leave_out_unsound(store, history);
  std::ranges::stable_sort(history.steps, [](const HistoryStep& a, const HistoryStep& b) {
    return std::abs(a.relative) > std::abs(b.relative);
  });
  return history;
}

}  // namespace taut
