#include "experiments/case/task.hpp"

#include <algorithm>

#include "core/model/text.hpp"

namespace taut {

Task task_of(const Record& r) {
  Task task{r.scene, r.spec.overrides, r.dt};
  std::erase_if(task.overrides, [](const auto& text) { return text.starts_with("time.dt="); });
  std::ranges::sort(task.overrides);
  return task;
}

std::string title_among(const Task& task, const std::set<Task>& among) {
  std::vector<std::string> own;
  for (const std::string& setting : task.overrides)
    if (std::ranges::any_of(among, [&](const Task& other) {
          return other.scene == task.scene &&
                 std::ranges::find(other.overrides, setting) == other.overrides.end();
        }))
      own.push_back(setting);
  return task.scene + (own.empty() ? "" : " (" + join(own, ", ") + ")");
}

}  // namespace taut
