#pragma once

#include <string>

#include "experiments/case/record.hpp"

namespace taut {

/// "hardly moves: 5 % of the way", for people, by the scene's reference in motion, or, where it has
/// none, by what its steps miss; "": it moves, or neither is known.
std::string hardly_moves(const Record&);
/// Whether the scene has a reference in motion that says so.
bool is_motion_judged(const Record&);
/// Whether the steps alone do.
bool is_judged_by_steps(const Record&);

}  // namespace taut
