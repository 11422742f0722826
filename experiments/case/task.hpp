#pragma once

#include <compare>
#include <set>
#include <string>

#include "experiments/case/record.hpp"

namespace taut {

/// A case without its solver: the scene, its settings and the time step.
struct Task {
  std::string scene;
  SceneSettings settings;  ///< without that of the time step, sorted
  double dt = 0;           ///< s
  auto operator<=>(const Task&) const = default;
};
Task task_of(const Record&);

/// The scene's name, with those of its settings that some other task on it does not have:
/// "hang (cloth.grid=[4, 4])".
std::string title_among(const Task&, const std::set<Task>&);

}  // namespace taut
