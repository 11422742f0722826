#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/solver/particles.hpp"
#include "core/solver/simd/kernels.hpp"

namespace taut {

/// All pairs of particles within a reach, by a uniform hash grid with cells of that size, sorted
/// by counting. The cells of one row along x lie in consecutive buckets, so that a cell and its
/// neighbours are five runs of particles: the rest of its own row and half of the eight around,
///
///     z + 1:  o o o     o: three cells of the row, C: the cell itself and the next,
///     z:      . C o     .: the pair is found from there
///     z - 1:  . . .     y to the right
///
/// and the particles of a cell share the look-up. Linear in the number of particles and pairs; the
/// order of the pairs depends on nothing but the positions.
template <class Real>
class Neighbours {
 public:
  explicit Neighbours(std::size_t particles, Simd simd = widest())
      : particles_(particles),
        rows_(particles),
        sorted_buckets_(particles),
        cells_(particles),
        meet_(kernels<Real>(simd).meet) {
    while (buckets_ < 2 * particles) buckets_ *= 2, --shift_;
    starts_.resize(buckets_ + 1);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      x_[axis].resize(particles + kNarrow), moved_[axis].resize(particles + kNarrow);
      query_.x[axis] = x_[axis].data(), query_.moved[axis] = moved_[axis].data();
    }
    query_.rows = rows_.data();
  }
  Neighbours(const Neighbours&) = delete;  // it points into itself

  std::size_t bytes() const {
    return particles_.size() * (2 * sizeof particles_[0] + sizeof(Row) + sizeof(Cell)) +
           6 * x_[0].size() * sizeof(Real) + starts_.size() * sizeof starts_[0] +
           found_.capacity() * sizeof(Meeting);
  }

  /// From the first of a pair to the second [m].
  class Apart {
   public:
    Triple<Real> now() const { return all_.gap(all_.x_, k_, m_); }
    Triple<Real> way() const { return all_.gap(all_.moved_, k_, m_); }  ///< since `previous`

   private:
    friend class Neighbours;
    Apart(const Neighbours& all, std::uint32_t k, std::uint32_t m) : all_(all), k_(k), m_(m) {}
    const Neighbours& all_;
    std::uint32_t k_, m_;
  };

  /// Calls visit(a, b) once for every pair less than `reach` [m], > 0, apart.
  template <class Visit>
  void pairs(const Points<Real>& x, Real reach, const Visit& visit) {
    meetings(x, x, reach, reach,
             [&](std::uint32_t a, std::uint32_t b, const Apart&) { visit(a, b); });
  }

  /// The same for those less than `within` and their own way since `previous` apart, together at
  /// most `reach`. Calls visit(a, b, apart).
  template <class Visit>
  void meetings(const Points<Real>& x, const Points<Real>& previous, Real within, Real reach,
                const Visit& visit) {
    sort(x, previous, reach);
    query_.within = within;
    const auto count = static_cast<std::uint32_t>(particles_.size());
    for (std::uint32_t begin = 0, end; begin < count; begin = end) {
      for (end = begin + 1; end < count && same_cell(begin, end);) ++end;
      const std::size_t found = meet(begin, end);
      for (std::size_t f = 0; f < found; ++f) {
        const auto [k, m] = found_[f];
        visit(particles_[k], particles_[m], Apart(*this, k, m));
      }
    }
  }

 private:
  using Row = std::uint64_t;  ///< a cell's y and z
  struct Cell {
    Row row;
    std::uint32_t bucket;
  };
  using Coordinates = std::vector<Real>[3];

  static constexpr Row pack(std::int64_t y, std::int64_t z) {
    return static_cast<Row>(y + z * (1LL << 32));
  }
  /// Beyond a million cells everything shares the last one.
  static std::int32_t number(Real v) {
    constexpr Real kFar = 1000000;
    const Real near = v > -kFar ? std::min(v, kFar) : -kFar;
    const auto towards_zero = static_cast<std::int32_t>(near);
    return towards_zero - (static_cast<Real>(towards_zero) > near ? 1 : 0);
  }
  std::uint32_t bucket_of(Row row, std::uint32_t x) const {
    const auto first =
        static_cast<std::uint32_t>((row * 0x9E3779B97F4A7C15u) >> shift_);  // Knuth's
    return (first + x) & static_cast<std::uint32_t>(buckets_ - 1);
  }

  void sort(const Points<Real>& x, const Points<Real>& previous, Real reach) {
    const Real per_metre = 1 / reach;
    std::fill(starts_.begin(), starts_.end(), 0);
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const auto at = x[i];
      const Row row = pack(number(at.y() * per_metre), number(at.z() * per_metre));
      const auto column = static_cast<std::uint32_t>(number(at.x() * per_metre));
      cells_[i] = {row, bucket_of(row, column)};
      ++starts_[cells_[i].bucket];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& start : starts_) sum += start, start = sum;  // ends, for now
    for (std::size_t i = cells_.size(); i-- > 0;) {
      const std::uint32_t k = --starts_[cells_[i].bucket];
      const auto at = x[i], before = previous[i];
      particles_[k] = static_cast<std::uint32_t>(i);
      rows_[k] = cells_[i].row, sorted_buckets_[k] = cells_[i].bucket;
      x_[0][k] = at.x(), x_[1][k] = at.y(), x_[2][k] = at.z();
      moved_[0][k] = at.x() - before.x(), moved_[1][k] = at.y() - before.y();
      moved_[2][k] = at.z() - before.z();
    }
  }

  bool same_cell(std::uint32_t k, std::uint32_t m) const {
    return rows_[k] == rows_[m] && sorted_buckets_[k] == sorted_buckets_[m];
  }
  static Triple<Real> gap(const Coordinates& of, std::uint32_t k, std::uint32_t m) {
    return {of[0][m] - of[0][k], of[1][m] - of[1][k], of[2][m] - of[2][k]};
  }

  /// Puts the pairs that the particles [begin, end) of a cell find into found_; how many.
  std::size_t meet(std::uint32_t begin, std::uint32_t end) {
    const Row row = rows_[begin];
    const std::uint32_t bucket = sorted_buckets_[begin];
    const std::uint32_t column = bucket - bucket_of(row, 0);
    query_.begin = begin, query_.end = end, query_.count = 0;
    add_run(bucket, 2, row);
    query_.runs[0].begin = begin;
    for (const Row step : {pack(1, 0), pack(-1, 1), pack(0, 1), pack(1, 1)})
      add_run(bucket_of(row + step, column - 1), 3, row + step);
    std::size_t most = 0;
    for (int r = 0; r < query_.count; ++r) most += query_.runs[r].end - query_.runs[r].begin;
    most *= end - begin;
    if (found_.size() < most) found_.resize(most);
    return meet_(query_, found_.data());
  }
  void add_run(std::uint32_t bucket, std::size_t count, Row row) {
    const auto add = [&](std::uint32_t begin, std::uint32_t end) {
      query_.runs[query_.count++] = {begin, end, row};
    };
    const std::size_t end = bucket + count;
    add(starts_[bucket], starts_[std::min(end, buckets_)]);
    if (end > buckets_) add(0, starts_[end - buckets_]);
  }

  std::vector<std::uint32_t> particles_;  ///< bucket after bucket
  std::vector<Row> rows_;                 ///< in that order
  std::vector<std::uint32_t> sorted_buckets_;
  Coordinates x_, moved_;              ///< likewise; kNarrow more, which no run contains
  std::vector<Cell> cells_;            ///< of each particle
  std::size_t buckets_ = 64;           ///< a power of two
  int shift_ = 64 - 6;                 ///< leaves the highest bits of a product, one per bucket
  std::vector<std::uint32_t> starts_;  ///< [buckets + 1]
  Meet<Real> meet_;
  MeetQuery<Real> query_{};
  std::vector<Meeting> found_;
};

}  // namespace taut
