#include "experiments/timing/way.hpp"

#include <cmath>

#include "core/model/names.hpp"
#include "experiments/answer/number.hpp"

namespace taut {

std::string_view to_string(WayGone::By by) {
  constexpr Names<WayGone::By::missed> kNames{"nothing", "reference", "exact steps", "missed"};
  return kNames[by];
}

WayGone way_gone(const Record& r) {
  const auto value = [&](std::string_view name) { return r.value(std::string(name)); };
  for (const ValueSpec* spec : values_with_role())
    if (spec->role == Role::motion && std::isfinite(value(spec->name)))
      return {WayGone::By::reference, value(spec->name)};
  if (std::isfinite(value(kShareOfWay))) return {WayGone::By::exact_steps, value(kShareOfWay)};
  if (std::isfinite(value(kShareBySteps))) return {WayGone::By::missed, value(kShareBySteps)};
  return {};
}

std::string hardly_moves(const Record& r) {
  const WayGone gone = way_gone(r);
  if (gone.by == WayGone::By::nothing) return "";
  if (gone.share >= kLeastMotion) return "";
  return "hardly moves: " + shown(kSignedShare, gone.share) + " of the way" +
         (gone.by == WayGone::By::exact_steps ? " of exact steps"
          : gone.by == WayGone::By::missed    ? ", by what its steps miss"
                                              : "");
}

}  // namespace taut
