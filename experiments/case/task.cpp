#include "experiments/case/task.hpp"

#include <algorithm>

#include "core/model/text.hpp"

namespace taut {

Task task_of(const Record& r) {
  Task task{r.scene, without(r.spec.settings, "time.dt"), r.dt};
  std::ranges::sort(task.settings);
  return task;
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
