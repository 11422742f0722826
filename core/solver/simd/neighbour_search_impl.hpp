#pragma once

// Included by kernels_impl.hpp, whose rules apply here, too; compiled once for each instruction
// set.

#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/lanes.hpp"

namespace taut {

/// Mask with a bit for each of the first `count` lanes, or for all lanes.
template <class T>
[[gnu::always_inline]] inline std::uint32_t first_lanes(std::uint32_t count) {
  constexpr std::uint32_t width = kWidth<T>;
  static_assert(width <= kSearchLanes);
  return (1u << (count < width ? count : width)) - 1;
}

/// Writes blocks of the particles in `count` buckets. Returns where the next block goes.
template <class T, class Real>
[[gnu::always_inline]] inline SearchBlock* write_blocks(const NeighbourSearch<Real>& q,
                                                        std::uint32_t bucket, std::uint32_t count,
                                                        SearchBlock* to) {
  const auto write = [&](std::uint32_t begin, std::uint32_t end) __attribute__((always_inline)) {
    for (std::uint32_t m = begin; m < end; m += kWidth<T>) *to++ = {m, first_lanes<T>(end - m)};
  };
  const std::uint32_t end = bucket + count;
  write(q.starts[bucket], q.starts[end < q.bucket_count ? end : q.bucket_count]);
  if (end > q.bucket_count) write(0, q.starts[end - q.bucket_count]);
  return to;
}

/// Writes the blocks of particles with which all particles of a cell are compared, except those of
/// the cell itself and of the next, which mostly follow directly. Returns the end of the blocks.
template <class T, class Real>
[[gnu::always_inline]] inline std::uint32_t write_surroundings(const NeighbourSearch<Real>& q,
                                                               std::uint32_t bucket,
                                                               SearchBlock*& to) {
  const std::uint32_t wrap = q.bucket_count - 1;
  for (const std::uint32_t step : {q.row, q.layer - q.row, q.layer, q.layer + q.row})
    to = write_blocks<T>(q, (bucket + step - 1) & wrap, 3, to);
  if (bucket < wrap) return q.starts[bucket + 2];
  to = write_blocks<T>(q, 0, 1, to);
  return q.particles;
}

/// The particle whose neighbours are searched for, in every lane. moving: false if no particle has
/// moved.
template <class T, bool moving>
struct Query {
  Vec3T<T> now, moved, rest;
  T within2, ignored2;

  template <class Real>
  [[gnu::always_inline]] Query(const NeighbourSearch<Real>& q, std::uint32_t k)
      : now(spread(q.now, k)),
        rest(spread(q.rest, k)),
        within2(q.within * q.within),
        ignored2(q.ignored * q.ignored) {
    if constexpr (moving) moved = spread(q.moved, k);
  }

  /// Mask of the particles from m on that are near it.
  template <class Real>
  [[gnu::always_inline]] std::uint32_t near(const NeighbourSearch<Real>& q, std::uint32_t m) const {
    const T gap2 = squared_norm(now - lanes(q.now, m));
    auto within = gap2 < within2;
    if constexpr (moving) {  // |gap| < within + |way|, without the roots
      const T way2 = squared_norm(moved - lanes(q.moved, m));
      const T more = gap2 - way2 - within2;
      within = more < T(0.0) || more * more < T(4.0) * within2 * way2;
    }
    return bits(within && squared_norm(rest - lanes(q.rest, m)) >= ignored2);
  }

 private:
  template <class Real>
  [[gnu::always_inline]] static Vec3T<T> spread(const Real* const (&from)[3], std::uint32_t k) {
    return {T(from[0][k]), T(from[1][k]), T(from[2][k])};
  }
  template <class Real>
  [[gnu::always_inline]] static Vec3T<T> lanes(const Real* const (&from)[3], std::uint32_t m) {
    return {load<T>(from[0] + m), load<T>(from[1] + m), load<T>(from[2] + m)};
  }
};

/// q is a copy, whose members no store can change.
template <class T, bool moving, class Real>
std::size_t find_pairs(const NeighbourSearch<Real> q, std::uint32_t& next, std::uint32_t last) {
  CandidatePair* found = q.found;
  std::uint32_t k = next;
  for (bool room = true; room && k < last;) {
    const std::uint32_t bucket = q.buckets[k], of_cell = q.starts[bucket + 1];
    const std::uint32_t end = of_cell < last ? of_cell : last;
    SearchBlock* blocks_end = q.blocks;
    const std::uint32_t next_end = write_surroundings<T>(q, bucket, blocks_end);
    const std::ptrdiff_t most = next_end - k + kWidth<T> * (blocks_end - q.blocks);
    for (; k < end; ++k) {
      room = q.found + q.room - found >= most;
      if (!room) break;
      const Query<T, moving> query(q, k);
      const auto add = [&](std::uint32_t m, std::uint32_t mask) __attribute__((always_inline)) {
        for (mask &= query.near(q, m); mask != 0; mask &= mask - 1)
          *found++ = {k, m + static_cast<std::uint32_t>(__builtin_ctz(mask))};
      };
      for (std::uint32_t m = k + 1; m < next_end; m += kWidth<T>)
        add(m, first_lanes<T>(next_end - m));
      for (const SearchBlock* b = q.blocks; b != blocks_end; ++b) add(b->first, b->mask);
    }
  }
  next = k;
  return static_cast<std::size_t>(found - q.found);
}
template <class T, class Real>
std::size_t find_pairs(const NeighbourSearch<Real>& search, std::uint32_t& next,
                       std::uint32_t end) {
  return search.moving ? find_pairs<T, true, Real>(search, next, end)
                       : find_pairs<T, false, Real>(search, next, end);
}

}  // namespace taut
