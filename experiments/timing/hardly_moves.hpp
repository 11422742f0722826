#pragma once

#include <string>

#include "experiments/case/record.hpp"

namespace taut {

/// Cloth that goes less than this share of the dynamic reference's way is not compared by strain:
/// links keep their lengths where nothing moves.
inline constexpr double kLeastMotion = 0.5;

/// "hardly moves: 5 % of the way", for people; "": it moves, or the scene has no reference in
/// motion.
std::string hardly_moves(const Record&);
/// Whether the scene has a reference in motion that says so.
bool is_motion_judged(const Record&);

}  // namespace taut
