#include "experiments/study/study_table.hpp"

#include <algorithm>
#include <iterator>
#include <map>

#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/system/distinct.hpp"

namespace taut {

namespace {

/// Text that distinguishes the cases of one scene: "jakobsen:iterations=4 dt=1/120".
std::string setting_of(const Case& one, const Study& study) {
  SceneSettings shared = study.settings;
  for (const std::string& scene : study.scenes)
    std::ranges::copy(parse_study_scene(scene).settings, std::back_inserter(shared));
  std::string text = one.choice.brief();
  for (const SceneSetting& change : one.spec.settings)
    if (std::ranges::find(shared, change) == shared.end()) text += " " + change.text();
  return text;
}

/// The value. A failed or extreme case shows its status instead, and an unsettled one has a note.
Cell cell(const Record& record, const std::string& value) {
  if (!completed(record.status)) return to_string(record.status.kind);
  Cell number(record.value(value));
  number.key = record.key;
  return record.status.kind == Status::Kind::unsettled ? number.with("~") : number;
}

}  // namespace

std::string ends_of(const std::vector<Record>& records) {
  std::map<Status::Kind, std::size_t> ends;
  for (const Record& r : records) ++ends[r.status.kind];
  return std::to_string(records.size()) + " cases: " + join(ends, ", ", [](const auto& end) {
           return std::string(to_string(end.first)) + " " + std::to_string(end.second);
         });
}

Table table_of(const Study& study, const Store& store, const std::string& value,
               const std::string& name) {
  const std::vector<Case> cases = cases_of(study);
  Table table{name, "", {{"setting", value}}};
  const auto scenes = distinct(cases, [](const Case& c) { return c.scene->name; });
  for (const std::string& scene : scenes)
    table.columns.emplace_back(scene, scene, unit_of_value(value));
  const auto settings = distinct(cases, [&](const Case& c) { return setting_of(c, study); });
  for (const std::string& setting : settings) {
    table.rows.emplace_back(scenes.size() + 1);
    table.rows.back()[0] = setting;
  }
  for (const Case& one : cases)
    if (const auto record = store.find(one)) {
      const auto row = std::ranges::find(settings, setting_of(one, study)) - settings.begin();
      const auto column = std::ranges::find(scenes, one.scene->name) - scenes.begin();
      table.rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column) + 1] =
          cell(*record, value);
    }
  return table;
}

}  // namespace taut
