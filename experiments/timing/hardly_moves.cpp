#include "experiments/timing/hardly_moves.hpp"

#include <cmath>

#include "experiments/answer/number.hpp"

namespace taut {

namespace {

/// By the reference in motion; NaN: it says nothing.
double share_of_reference(const Record& r) {
  double share = std::nan("");
  for (const ValueSpec* value : values_with_role())
    if (value->role == Role::motion && std::isnan(share)) share = r.value(std::string(value->name));
  return share;
}
double share_by_steps(const Record& r) { return r.value(std::string(kShareBySteps)); }
std::string said(double share) {
  return "hardly moves: " + shown(kSignedShare, share) + " of the way";
}

}  // namespace

std::string hardly_moves(const Record& r) {
  if (is_motion_judged(r))
    return share_of_reference(r) < kLeastMotion ? said(share_of_reference(r)) : "";
  return share_by_steps(r) < kLeastByStepsAlone
             ? said(share_by_steps(r)) + ", by what its steps miss"
             : "";
}

bool is_motion_judged(const Record& r) { return std::isfinite(share_of_reference(r)); }

bool is_judged_by_steps(const Record& r) {
  return !is_motion_judged(r) && std::isfinite(share_by_steps(r));
}

}  // namespace taut
