#pragma once

#include <cstddef>
#include <cstdint>

namespace taut {

/// A search looks at up to so many particles at once.
inline constexpr std::uint32_t kSearchLanes = 8;

/// As many particles from the first on as there are lanes, a bit for each that counts.
struct SearchBlock {
  std::uint32_t first, mask;
};
struct Meeting {
  std::uint32_t a, b;
};

/// Particles sorted by the cells of a grid (`contact/neighbours.hpp`).
template <class Real>
struct MeetQuery {
  /// [particles + kSearchLanes] where each is, how far it has moved in the step, and where it is at
  /// rest: x, y, z [m].
  const Real *now[3], *moved[3], *rest[3];
  const std::uint32_t* buckets;           ///< [particles] where the cell of each is
  const std::uint32_t* starts;            ///< [bucket_count + 1] first particle of each bucket
  std::uint32_t particles, bucket_count;  ///< the latter a power of two
  std::uint32_t row, layer;               ///< buckets from a cell to the next in y and in z
  Real within, ignored;                   ///< m
  SearchBlock* blocks;                    ///< scratch: [particles + 10]
  Meeting* found;                         ///< [room], at least particles + 11 kSearchLanes
  std::size_t room;
};
/// Finds the pairs that are less than `within` and their own way in the step apart and at rest are
/// not less than `ignored` apart; how many. Goes on from particle `next`, which it moves on, until
/// all are done or the next one might find more than there is room for.
template <class Real>
using Meet = std::size_t (*)(const MeetQuery<Real>&, std::uint32_t& next);

}  // namespace taut
