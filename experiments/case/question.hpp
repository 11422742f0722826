#pragma once

#include <compare>
#include <set>
#include <string>
#include <vector>

#include "experiments/case/record.hpp"

namespace taut {

/// What a case is asked, apart from the solver: scene, its settings and the time step.
struct Question {
  std::string scene;
  std::vector<std::string> overrides;  ///< without that of the time step, sorted
  double dt = 0;                       ///< s
  auto operator<=>(const Question&) const = default;
};
Question question_of(const Record&);

/// The scene's name, with those of its settings that some other question on it does not have:
/// "hang (cloth.grid=[4, 4])".
std::string title_among(const Question&, const std::set<Question>& asked);

}  // namespace taut
