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
  SceneSettings settings;  ///< without that of the time step, sorted
  double dt = 0;           ///< s
  auto operator<=>(const Task&) const = default;
};
Task task_of(const Record&);

/// Table of a scene's settings with the stiffness [N/m] of each family of links.
inline constexpr std::string_view kLinksStiffness = "links.stiffness";
/// The numbers of that table by family: equal however they are written. Empty if the settings have
/// no such table, or one that is empty or no table of numbers.
std::map<std::string, double> links_stiffness(const SceneSettings&);

/// The scene's name, with those of its settings that some other task on it does not have:
/// "hang (cloth.grid=[4, 4])".
std::string title_among(const Task&, const std::set<Task>&);

}  // namespace taut
