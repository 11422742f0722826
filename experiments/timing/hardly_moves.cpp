#include "experiments/timing/hardly_moves.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/answer/number.hpp"

namespace taut {

std::string hardly_moves(const Record& r) {
  for (const ValueSpec* value : values_with_role())
    if (const double share = r.value(std::string(value->name));
        value->role == Role::motion && share < kLeastMotion)
      return "hardly moves: " + shown(value->unit, share) + " of the way";
  return "";
}

bool is_motion_judged(const Record& r) {
  return std::ranges::any_of(values_with_role(), [&](const ValueSpec* value) {
    return value->role == Role::motion && std::isfinite(r.value(std::string(value->name)));
  });
}

}  // namespace taut
