#pragma once

#include <compare>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "experiments/case/record.hpp"

namespace taut {

/// A case without its solver: the scene, its settings and the time step.
struct Task {
  std::string scene;
  SceneSettings settings;  ///< sorted, without the setting of the time step
  double dt = 0;           ///< s
  auto operator<=>(const Task&) const = default;
};
Task task_of(const Record&);

/// Table of a scene's settings with the stiffness [N/m] of each family of links.
inline constexpr std::string_view kLinksStiffness = "links.stiffness";
/// The numbers of that table by family, so that spelling makes no difference. Empty if the settings
/// have no such table, or if it is empty or no table of numbers.
std::map<std::string, double> links_stiffness(const SceneSettings&);

/// The scene's name, with the settings that some other task on this scene lacks:
/// "hang (cloth.grid=[4, 4])".
std::string title_among(const Task&, const std::set<Task>&);

}  // namespace taut
