// How the values of a study changed from build to build.
#include <algorithm>
#include <cmath>
#include <map>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/history/history_answer.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/model/parts.hpp"

namespace taut::report {

namespace {

constexpr std::size_t kMostBuilds = 200, kMostSentences = 20, kMostValues = 40;

/// A case in a build: the key of its result, and its entry among the page's cases, if it has one.
Json json_of_point(const HistoryPoint* point, const std::map<std::string, const Record*>& listed,
                   CaseList& refs) {
  Json one{{"status", point ? describe(point->status) : "no result"}};
  if (!point) return one;
  one["key"] = point->key.substr(0, 12);
  if (const auto at = listed.find(point->key); at != listed.end())
    one["case"] = refs.key(*at->second);
  return one;
}

/// The changes in a step, as the page shows them.
Json json_of_change(const History& history, const HistoryStep& step, CaseList& refs) {
  const std::string name = step.what.name();
  Json value{{"value", name}, {"title", name}};
  switch (step.what.kind) {
    case Changing::Kind::status:
      value["text"] = status_change(history, step);
      break;
    case Changing::Kind::cpu:
      value["title"] = "CPU time of a step";
      value["text"] = number_text(step.is) + " times";
      break;
    case Changing::Kind::wall:
      value["title"] = "wall time of a step";
      value["text"] = number_text(step.is) + " times";
      break;
    case Changing::Kind::value:
      value["title"] = refs.use(name).title;
      value["text"] = number_text(step.was, unit_of_value(name), 4) + " -> " +
                      number_text(step.is, unit_of_value(name), 4);
  }
  return value;
}

/// Steps of a case, by build: both builds and all values that stepped.
Json json_of_row_steps(const History& history, std::size_t row, std::size_t first,
                       const std::map<std::string, const Record*>& listed, CaseList& refs) {
  std::map<std::size_t, Json> by_build;
  for (const HistoryStep& step : history.steps) {
    if (step.row != row || step.now < first) continue;
    const auto& points = history.rows[row].points;
    Json& one = by_build[step.now];
    if (one.is_null())
      one = {{"at", step.now - first},
             {"before", short_build(history.builds[step.before].id)},
             {"now", short_build(history.builds[step.now].id)},
             {"cases", Json::array({json_of_point(points[step.before].get(), listed, refs),
                                    json_of_point(points[step.now].get(), listed, refs)})}};
    if (one["values"].size() >= kMostValues) continue;
    one["values"].push_back(json_of_change(history, step, refs));
  }
  Json all;
  for (auto& [build, one] : by_build) all.push_back(std::move(one));
  return all;
}

Json json_of_study(const History& history, const std::map<std::string, const Record*>& listed,
                   CaseList& refs) {
  const std::size_t count = history.builds.size(), first = count - std::min(count, kMostBuilds);
  Json one{{"study", history.study}, {"metric", kErrorMetric}, {"builds", Json::array()}};
  refs.use(kErrorMetric);
  for (std::size_t i = first; i < count; ++i) {
    const Build& build = history.builds[i];
    Json at{{"id", short_build(build.id)}, {"made", build.made}};
    add_if(at, "subject", build.subject);
    add_if(at, "gap", build.gap);
    one["builds"].push_back(std::move(at));
  }
  if (first > 0) one["earlier"] = first;
  for (const SteppedValue& step : stepped_values(history))
    if (one["sentences"].size() < kMostSentences) one["sentences"].push_back(step.sentence);
  for (std::size_t r = 0; r < history.rows.size(); ++r) {
    const HistoryRow& row = history.rows[r];
    Json line{{"id", row.id}, {"solver", row.solver}, {"values", Json::array()}};
    for (std::size_t i = first; i < count; ++i) {
      const auto* point = row.points[i].get();
      const auto at = point ? point->values.find(kErrorMetric) : MetricValues::const_iterator();
      const bool has = point && at != point->values.end() && std::isfinite(at->second);
      line["values"].push_back(has ? Json(rounded_to(at->second, 5)) : Json());
    }
    add_if(line, "steps", json_of_row_steps(history, r, first, listed, refs));
    one["rows"].push_back(std::move(line));
  }
  return one;
}

}  // namespace

Json json_of_history(const ReportInput& input, CaseList& refs) {
  std::map<std::string, const Record*> listed;
  for (const Record* r : refs.cases()) listed[r->key] = r;
  Json all;
  for (const History& history : input.histories)
    if (history.builds.size() > 1 && !history.rows.empty())
      all.push_back(json_of_study(history, listed, refs));
  return all;
}

}  // namespace taut::report
