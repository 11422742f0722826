#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/solver/particles.hpp"

namespace taut {

/// All pairs of particles within a reach, by a uniform hash grid with cells of that size: sorted
/// into cells by counting, then each cell against itself and half of its 26 neighbours. Linear in
/// the number of particles and pairs; the order of the pairs depends on nothing but the positions.
template <class Real>
class Neighbours {
 public:
  using Point = Eigen::Matrix<Real, 3, 1>;

  explicit Neighbours(std::size_t particles) : entries_(particles), keys_(particles) {
    while (buckets_ < 2 * particles) buckets_ *= 2, --shift_;
    starts_.resize(buckets_ + 1);
  }

  std::size_t bytes() const {
    return entries_.size() * sizeof(Entry) + keys_.size() * sizeof(Cell) +
           starts_.size() * sizeof(std::uint32_t);
  }

  /// Calls visit(a, b) once for every pair within `reach` [m], > 0.
  template <class Visit>
  void pairs(const Points<Real>& x, Real reach, const Visit& visit) {
    sort(x, reach);
    const Real reach2 = reach * reach;
    for (std::uint32_t bucket = 0; bucket < buckets_; ++bucket)
      for (std::uint32_t k = starts_[bucket]; k < starts_[bucket + 1]; ++k) {
        const Entry& a = entries_[k];
        const auto compare = [&](const Entry& b) {
          if ((b.x - a.x).squaredNorm() < reach2) visit(a.particle, b.particle);
        };
        for (std::uint32_t m = k + 1; m < starts_[bucket + 1]; ++m)
          if (entries_[m].cell == a.cell) compare(entries_[m]);
        for (const Cell step : kHalf) {
          const Cell cell = a.cell + step;
          const std::uint32_t other = bucket_of(cell);
          for (std::uint32_t m = starts_[other]; m < starts_[other + 1]; ++m)
            if (entries_[m].cell == cell) compare(entries_[m]);
        }
      }
  }

 private:
  /// Three cell numbers of 21 bits each, biased so that neighbours are sums.
  using Cell = std::uint64_t;
  struct Entry {
    Point x;
    std::uint32_t particle = 0;
    Cell cell = 0;
  };
  static constexpr Cell pack(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<Cell>(x + y * (1LL << 21) + z * (1LL << 42));
  }
  /// One of each two opposite neighbours.
  static constexpr Cell kHalf[] = {pack(1, 0, 0),   pack(-1, 1, 0), pack(0, 1, 0),  pack(1, 1, 0),
                                   pack(-1, -1, 1), pack(0, -1, 1), pack(1, -1, 1), pack(-1, 0, 1),
                                   pack(0, 0, 1),   pack(1, 0, 1),  pack(-1, 1, 1), pack(0, 1, 1),
                                   pack(1, 1, 1)};

  static Cell cell_of(const Point& x, Real per_metre) {
    const auto number = [&](Real v) {
      constexpr Real kFar = 1000000;  // beyond that everything shares the last cell
      const Real scaled = std::floor(v * per_metre);
      return static_cast<std::int64_t>(scaled > -kFar ? std::min(scaled, kFar) : -kFar) + (1 << 20);
    };
    return pack(number(x.x()), number(x.y()), number(x.z()));
  }
  std::uint32_t bucket_of(Cell cell) const {
    return static_cast<std::uint32_t>((cell * 0x9E3779B97F4A7C15u) >> shift_);  // Knuth's
  }

  void sort(const Points<Real>& x, Real reach) {
    std::fill(starts_.begin(), starts_.end(), 0);
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      keys_[i] = cell_of(x[i], 1 / reach);
      ++starts_[bucket_of(keys_[i])];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& start : starts_) sum += start, start = sum;  // ends, for now
    for (std::size_t i = keys_.size(); i-- > 0;)
      entries_[--starts_[bucket_of(keys_[i])]] = {x[i], static_cast<std::uint32_t>(i), keys_[i]};
  }

  std::vector<Entry> entries_;
  std::vector<Cell> keys_;
  std::size_t buckets_ = 64;  ///< a power of two
  int shift_ = 64 - 6;        ///< leaves the highest bits of a product, one number per bucket
  std::vector<std::uint32_t> starts_;  ///< [buckets + 1]
};

}  // namespace taut
