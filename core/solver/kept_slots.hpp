#pragma once

#include <array>
#include <map>
#include <vector>

#include "core/solver/springs.hpp"

namespace taut {

/// Per-spring data, stored in slots at each end that moves.
template <class Slots>
struct SlotsOfSprings {
  const VertexGroups& groups;
  const std::vector<Spring>& springs;
  Slots& slots;  ///< a vector of slots

  /// Calls f({a, b, the end's vertex}, slot, lane) for each end that moves.
  template <class F>
  void each(const F& f) const {
    const Adjacency ends = ends_of(springs, groups.layout().size());
    for (std::size_t g = 0; g < groups.size(); ++g)
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const int v = groups.vertex(g, lane);
        if (v < 0) continue;
        std::size_t s = groups.data()[g].first_slot;
        for (const Adjacency::End& end : ends.of(v)) {
          const Spring& spring = springs[to_index(end.link)];
          f(std::array{spring.a, spring.b, to_index(v)}, slots[s++], lane);
        }
      }
  }
};

/// Hands over per-spring data after pins were released. Calls take(slot, lane, earlier slot, its
/// lane, sign) for each end of a spring that had a slot before. sign is 1; it is -1 where the end
/// was a pin, and the earlier slot is then that of the spring's other end.
template <class Slot, class Take>
void take_over(const SlotsOfSprings<std::vector<Slot>>& now,
               const SlotsOfSprings<const std::vector<Slot>>& earlier, const Take& take) {
  std::map<std::array<std::size_t, 3>, std::pair<const Slot*, std::size_t>> had;
  earlier.each([&](const auto& end, const Slot& slot, std::size_t lane) {
    had[end] = {&slot, lane};
  });
  now.each([&](const auto& end, Slot& slot, std::size_t lane) {
    const auto [a, b, v] = end;
    const auto own = had.find(end);
    const auto other = had.find({a, b, a + b - v});
    if (own != had.end())
      take(slot, lane, *own->second.first, own->second.second, 1);
    else if (other != had.end())
      take(slot, lane, *other->second.first, other->second.second, -1);
  });
}

}  // namespace taut
