#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"

namespace taut {

/// All pairs of particles within a reach, by a uniform grid with cells of that size, sorted by
/// counting. Cell (i, j, k) is bucket i + row j + layer k, modulo the number of buckets: the grid
/// wraps around, without end and without a hash. Cells next to each other in x are buckets next to
/// each other, so that a cell and its neighbours are five runs of particles,
///
///     z + 1:  o o o     o: three cells of a row in x, C: the cell itself and the next,
///     z:      . C o     .: the pair is found from there
///     z - 1:  . . .     y to the right
///
/// no two of which share a bucket, as a row has eight or more and a layer eight rows. Which sizes
/// they have depends on the extent of the cloth, so that few cells lie on one another; those that
/// do are far apart and are compared in vain. Linear in the number of particles and pairs; the
/// order of the pairs depends on nothing but the positions.
template <class Real>
class NeighbourGrid {
 public:
  explicit NeighbourGrid(std::size_t particles, Simd simd = widest())
      : particles_(particles),
        buckets_(particles),
        sorted_buckets_(particles),
        find_pairs_(kernels<Real>(simd).find_pairs) {
    while (bucket_count_ < 2 * particles) bucket_count_ *= 2;
    starts_.resize(bucket_count_ + 1);
    for (Coordinates* c : {&now_, &moved_, &at_rest_})
      for (auto& array : *c) array.resize(particles + kSearchLanes);
    blocks_.resize(particles + 10);
    found_.resize(particles + kAtOnce);
  }

  std::size_t size() const { return particles_.size(); }  ///< particles
  std::size_t bytes() const {
    return (3 * particles_.size() + starts_.size()) * sizeof starts_[0] +
           9 * now_[0].size() * sizeof(Real) + rest_.size() * sizeof rest_[0] +
           blocks_.size() * sizeof(SearchBlock) + found_.size() * sizeof(CandidatePair);
  }

  /// From now on ignores pairs that are less than `within` [m] apart at rest.
  void ignore(const Points<Real>& rest, Real within) {
    ignored_ = within;
    rest.read([&](const auto& at) {
      for (std::size_t i = 0; i < particles_.size(); ++i) rest_.push_back(at(rest, i));
    });
  }

  /// Calls visit(a, b) once for every pair less than `reach` [m], > 0, apart.
  template <class Visit>
  void pairs(const Points<Real>& x, Real reach, const Visit& visit) {
    find(x, nullptr, reach, reach, visit);
  }

  /// The same for those less than `within` and their own way since `previous` apart, together at
  /// most `reach`.
  template <class Visit>
  void moving_pairs(const Points<Real>& x, const Points<Real>& previous, Real within, Real reach,
                    const Visit& visit) {
    find(x, &previous, within, reach, visit);
  }

 private:
  static constexpr std::size_t kAtOnce = 1024;
  using Coordinates = std::array<std::vector<Real>, 3>;

  static constexpr Real kCells = 1000000;

  /// previous: null if none has moved.
  template <class Visit>
  void find(const Points<Real>& x, const Points<Real>* previous, Real within, Real reach,
            const Visit& visit) {
    x.read([&](const auto& at) { sort(x, previous, reach, at); });
    const auto point_to = [](const Coordinates& c, const Real*(&to)[3]) {
      for (std::size_t axis = 0; axis < 3; ++axis) to[axis] = c[axis].data();
    };
    NeighbourSearch<Real> search{.buckets = sorted_buckets_.data(),
                                 .starts = starts_.data(),
                                 .particles = static_cast<std::uint32_t>(particles_.size()),
                                 .bucket_count = bucket_count_,
                                 .row = row_,
                                 .layer = layer_,
                                 .within = within,
                                 .ignored = ignored_,
                                 .moving = previous != nullptr,
                                 .blocks = blocks_.data(),
                                 .found = found_.data(),
                                 .room = found_.size()};
    point_to(now_, search.now), point_to(moved_, search.moved), point_to(at_rest_, search.rest);
    for (std::uint32_t next = 0; next < search.particles;) {
      const std::size_t count = find_pairs_(search, next);
      for (std::size_t f = 0; f < count; ++f)
        visit(particles_[found_[f].a], particles_[found_[f].b]);
    }
  }

  [[gnu::always_inline]] static void set(Coordinates& to, std::size_t k, const Vec4T<Real>& p) {
    to[0][k] = p.v[0], to[1][k] = p.v[1], to[2][k] = p.v[2];
  }

  /// Sets where the cells begin and how wide they are, and row_ and layer_: the grid that fits the
  /// extent of x best. At most a million cells along an axis, so that their numbers are exact.
  template <class At>
  void fit_grid(const Points<Real>& x, Real reach, const At& at) {
    Vec4T<Real> least = at(x, 0), most = least;
    for (std::size_t i = 1; i < particles_.size(); ++i)
      least = lesser(least, at(x, i)), most = greater(most, at(x, i));
    const Vec4T<Real> extent = most - least;
    const Real widest = std::max({extent.v[0], extent.v[1], extent.v[2]});
    origin_ = least, per_metre_ = 1 / std::max(reach, widest / kCells);
    std::uint32_t cells[3] = {8, 8, 8};
    for (std::uint32_t all = 8 * 8 * 8; all < bucket_count_; all *= 2) {
      const auto share = [&](int axis) { return extent.v[axis] / static_cast<Real>(cells[axis]); };
      const bool x_longest = share(0) >= share(1) && share(0) >= share(2);
      cells[x_longest ? 0 : share(1) >= share(2) ? 1 : 2] *= 2;
    }
    row_ = cells[0], layer_ = cells[0] * cells[1];
  }

  std::uint32_t bucket_of(const Vec4T<Real>& x) const {
    const Vec4T<Real> cell = per_metre_ * (x - origin_);
    // A state that has gone to infinity has some cell, too.
    const auto number = [&](int axis) {
      return static_cast<std::uint32_t>(cell.v[axis] < 2 * kCells ? cell.v[axis] : 0);
    };
    return (number(0) + row_ * number(1) + layer_ * number(2)) & (bucket_count_ - 1);
  }

  template <class At>
  void sort(const Points<Real>& x, const Points<Real>* previous, Real reach, const At& at) {
    fit_grid(x, reach, at);
    std::uint32_t* const starts = starts_.data();
    std::fill(starts_.begin(), starts_.end(), 0);
    for (std::size_t i = 0; i < buckets_.size(); ++i) ++starts[buckets_[i] = bucket_of(at(x, i))];
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b <= bucket_count_; ++b) sum += starts[b], starts[b] = sum;  // ends
    for (std::size_t i = buckets_.size(); i-- > 0;) {
      const std::uint32_t bucket = buckets_[i], k = --starts[bucket];
      particles_[k] = static_cast<std::uint32_t>(i), sorted_buckets_[k] = bucket;
      const Vec4T<Real> p = at(x, i);
      set(now_, k, p);
      if (previous) set(moved_, k, p - at(*previous, i));
      if (!rest_.empty()) set(at_rest_, k, rest_[i]);
    }
  }

  std::vector<std::uint32_t> particles_;       ///< bucket after bucket
  std::vector<std::uint32_t> buckets_;         ///< of each particle
  std::vector<std::uint32_t> sorted_buckets_;  ///< in the order of particles_
  Coordinates now_, moved_, at_rest_;          ///< likewise; room for kSearchLanes more
  std::vector<Vec4T<Real>> rest_;              ///< [particles] m; empty: none is ignored
  Real ignored_ = 0;                           ///< m
  std::uint32_t bucket_count_ = 8 * 8 * 8;     ///< a power of two
  std::uint32_t row_ = 8, layer_ = 64;
  Vec4T<Real> origin_{};
  Real per_metre_ = 1;
  std::vector<std::uint32_t> starts_;  ///< [bucket_count + 1]
  FindPairs<Real> find_pairs_;
  std::vector<SearchBlock> blocks_;
  std::vector<CandidatePair> found_;
};

}  // namespace taut
