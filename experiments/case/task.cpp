#include "experiments/case/task.hpp"

#include <algorithm>

#include "core/io/document.hpp"
#include "core/model/text.hpp"

namespace taut {

Task task_of(const Record& r) {
  Task task{r.scene, without(r.spec.settings, "time.dt"), r.dt};
  std::ranges::sort(task.settings);
  return task;
}

std::map<std::string, double> links_stiffness(const SceneSettings& settings) try {
  const SceneSetting* setting = find_setting(settings, kLinksStiffness);
  if (!setting) return {};
  const Document document = parse_document("a setting", "", {*setting});
  const Value* links = document.root.find("links");
  const Value* table = links ? links->find("stiffness") : nullptr;
  if (!table || !table->is_table()) return {};
  std::map<std::string, double> all;
  for (std::size_t i = 0; i < table->keys.size(); ++i) {
    if (!table->items[i].is_number()) return {};
    all[table->keys[i].text] = table->items[i].number;
  }
  return all;
} catch (const InputError&) {  // no program of this version ran it
  return {};
}

std::string title_among(const Task& task, const std::set<Task>& among) {
  SceneSettings own;
  for (const SceneSetting& setting : task.settings)
    if (std::ranges::any_of(among, [&](const Task& other) {
          return other.scene == task.scene &&
                 std::ranges::find(other.settings, setting) == other.settings.end();
        }))
      own.push_back(setting);
  return task.scene + (own.empty() ? "" : " (" + join(own, ", ", &SceneSetting::text) + ")");
}

}  // namespace taut
