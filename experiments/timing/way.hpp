#pragma once

#include <string>
#include <string_view>

#include "experiments/case/record.hpp"

namespace taut {

/// Share of its way that a cloth travels: measured by the scene's reference in motion; else by
/// exact steps from its start; else by what its own steps miss compared with exact ones.
struct WayGone {
  enum class By { nothing, reference, exact_steps, missed };
  By by = By::nothing;
  double share = 0;  ///< 1: the whole way
};
WayGone way_gone(const Record&);
/// "nothing", "reference", "exact steps", "missed".
std::string_view to_string(WayGone::By);

/// "hardly moves: 5 % of the way", for people; "" if it travels at least half of its way or that is
/// not known.
std::string hardly_moves(const Record&);

}  // namespace taut
