#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/thread_pool.hpp"

namespace taut {

/// Finds all pairs of particles within a reach, by a uniform grid with cells of that size, sorted
/// by counting. Cell (i, j, k) is bucket i + row j + layer k, modulo the number of buckets: the
/// grid wraps around, without bounds and without a hash. Cells that are adjacent in x are adjacent
/// buckets, so a cell and its neighbours are five runs of particles,
///
///     z + 1:  o o o     o: three cells of a row in x, C: the cell itself and the next,
///     z:      . C o     .: the pair is found from there
///     z - 1:  . . .     y to the right
///
/// no two of which share a bucket, because a row has eight or more buckets and a layer eight rows.
/// Their sizes depend on the extent of the cloth, so that few cells share a bucket; cells that do
/// are far apart, and comparing them finds nothing. Linear in the number of particles and pairs.
///
/// Pairs come in lists, so that threads can process them. The particles, in the order of their
/// cells, are cut into parts with about as many comparisons each. For part n, list n has the pairs
/// inside it, list parts() + n those with the next part, and list 2 parts() + n the few others,
/// from one end of the grid to the other or across a part of few particles. Lists and their order
/// depend only on the positions.
template <class Real>
class NeighbourGrid {
 public:
  explicit NeighbourGrid(std::size_t particles, ThreadPool& pool, Simd simd = widest())
      : pool_(pool),
        particles_(particles),
        buckets_(particles),
        sorted_buckets_(particles),
        find_pairs_(kernels<Real>(simd).find_pairs) {
    while (bucket_count_ < 2 * particles) bucket_count_ *= 2;
    starts_.resize(bucket_count_ + 1);
    for (Coordinates* c : {&now_, &moved_, &at_rest_})
      for (auto& array : *c) array.resize(particles + kSearchLanes);
    const bool shared = particles >= ThreadPool::kWorthSharing;
    parts_.resize(shared ? kParts : 1);
    for (Part& part : parts_) part.blocks.resize(particles + 10);
    if (shared) comparisons_.resize((particles + kSample - 1) / kSample);
    counts_.resize(shared ? pool.threads() : 1);
    for (Count& count : counts_) {
      if (&count != counts_.data()) count.ends.resize(bucket_count_);
      count.before.resize(counts_.size());
    }
  }

  std::size_t size() const { return particles_.size(); }  ///< number of particles
  std::size_t parts() const { return parts_.size(); }
  std::size_t bytes() const {
    std::size_t sum = (3 * particles_.size() + starts_.size()) * sizeof starts_[0] +
                      9 * now_[0].size() * sizeof(Real) + rest_.size() * sizeof rest_[0] +
                      comparisons_.size() * sizeof comparisons_[0];
    for (const Part& part : parts_)
      sum += part.blocks.size() * sizeof(SearchBlock) + part.found.size() * sizeof(CandidatePair);
    for (const Count& count : counts_)
      sum += (count.ends.size() + count.before.size()) * sizeof count.ends[0];
    return sum;
  }

  /// Ignores from now on pairs that are less than `within` [m] apart at rest.
  void ignore(const Points<Real>& rest, Real within) {
    ignored_ = within;
    rest.read([&](const auto& at) {
      for (std::size_t i = 0; i < particles_.size(); ++i) rest_.push_back(at(rest, i));
    });
  }

  /// Calls visit(list, a, b) once for every pair less than `reach` [m] apart, > 0; at the same time
  /// for lists of different parts.
  template <class Visit>
  void pairs(const Points<Real>& x, Real reach, const Visit& visit) {
    find(x, nullptr, reach, reach, visit);
  }

  /// Like pairs(), for pairs that are less than `within` plus their relative motion since
  /// `previous` apart; together this is at most `reach`.
  template <class Visit>
  void moving_pairs(const Points<Real>& x, const Points<Real>& previous, Real within, Real reach,
                    const Visit& visit) {
    find(x, &previous, within, reach, visit);
  }

 private:
  /// Data for searching the neighbours of one part of the particles.
  struct Part {
    std::size_t begin = 0;  ///< first particle, in the order of the cells
    std::vector<SearchBlock> blocks;
    std::vector<CandidatePair> found;
    std::size_t count = 0;  ///< number of pairs in `found`
    Vec4T<Real> least, most;
  };
  /// Data of a thread for sorting its share of the particles.
  struct Count {
    /// [bucket_count] end of its particles in each bucket; the first thread's are starts_.
    std::vector<std::uint32_t> ends;
    /// [threads] number of particles in a bucket before each share.
    std::vector<std::uint32_t> before;
  };
  using Coordinates = std::array<std::vector<Real>, 3>;

  static constexpr Real kCells = 1000000;
  static constexpr std::size_t kParts = 8;
  /// One particle in this many has its comparisons counted.
  static constexpr std::size_t kSample = 16;

  /// previous: null if no particle has moved.
  template <class Visit>
  void find(const Points<Real>& x, const Points<Real>* previous, Real within, Real reach,
            const Visit& visit) {
    const NeighbourSearch<Real> search = prepared(x, previous, within, reach);
    pool_.run(parts(), [&](std::size_t first, std::size_t last) {
      for (std::size_t n = first; n < last; ++n) {
        const std::size_t begin = parts_[n].begin, end = begin_of(n + 1), next = begin_of(n + 2);
        find_part(search, n, begin, end);
        for (std::size_t f = 0; f < parts_[n].count; ++f) {
          const auto [a, b] = parts_[n].found[f];
          const std::size_t kind = b >= begin && b < end ? 0 : b >= end && b < next ? 1 : 2;
          visit(kind * parts() + n, particles_[a], particles_[b]);
        }
      }
    });
  }

  /// Sorts the particles and cuts them into parts. Separate from find(), to be compiled once for
  /// all visits.
  NeighbourSearch<Real> prepared(const Points<Real>& x, const Points<Real>* previous, Real within,
                                 Real reach) {
    x.read([&](const auto& at) { sort(x, previous, reach, at); });
    cut_into_parts();
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
                                 .moving = previous != nullptr};
    point_to(now_, search.now);
    point_to(moved_, search.moved);
    point_to(at_rest_, search.rest);
    return search;
  }

  std::size_t begin_of(std::size_t part) const {
    return part < parts() ? parts_[part].begin : size();
  }

  /// Approximate number of comparisons of the k-th particle in the order of the cells.
  std::uint32_t comparisons_of(std::size_t k) const {
    std::uint32_t all = 1;
    for (const std::uint32_t step : {0U, row_, layer_ - row_, layer_, layer_ + row_}) {
      const std::uint32_t bucket = (sorted_buckets_[k] + step - 1) & (bucket_count_ - 1);
      all += starts_[std::min(bucket + 3, bucket_count_)] - starts_[bucket];
    }
    return all;
  }

  /// Cuts the particles into parts with about as many comparisons each: a crumpled cloth has most
  /// of them in few of its cells.
  void cut_into_parts() {
    const auto all = std::accumulate(comparisons_.begin(), comparisons_.end(), std::uint64_t{0});
    std::uint64_t sum = 0;
    std::size_t sample = 0;
    for (std::size_t n = 0; n < parts(); ++n) {
      while (sum * parts() < all * n) sum += comparisons_[sample++];
      parts_[n].begin = std::min(sample * kSample, size());
    }
  }

  /// Finds the pairs of the particles of part n with those after them.
  void find_part(NeighbourSearch<Real> search, std::size_t n, std::size_t begin, std::size_t end) {
    Part& part = parts_[n];
    const auto last = static_cast<std::uint32_t>(end);
    part.count = 0;
    search.blocks = part.blocks.data();
    for (auto next = static_cast<std::uint32_t>(begin); next < last;) {
      search.found = part.found.data() + part.count;
      search.room = part.found.size() - part.count;
      const std::size_t count = find_pairs_(search, next, last);
      part.count += count;
      if (next < last)  // there is no room for what the next one might find
        part.found.resize(std::max<std::size_t>(1024, 2 * part.found.size()));
    }
  }

  /// Calls f(n, begin, end) for shares of the particles, as many as there are parts.
  template <class F>
  void for_each_share(const F& f) {
    pool_.run_parts(parts_.size(), particles_.size(), f);
  }

  [[gnu::always_inline]] static void set(Coordinates& to, std::size_t k, const Vec4T<Real>& p) {
    to[0][k] = p.v[0];
    to[1][k] = p.v[1];
    to[2][k] = p.v[2];
  }

  /// Fits the grid to the extent of x: sets origin and width of the cells, row_ and layer_. At most
  /// a million cells along an axis, so that their numbers are exact.
  template <class At>
  void fit_grid(const Points<Real>& x, Real reach, const At& at) {
    for_each_share([&](std::size_t n, std::size_t begin, std::size_t end) {
      Vec4T<Real> least = at(x, begin), most = least;
      for (std::size_t i = begin; i < end; ++i) {
        least = lesser(least, at(x, i));
        most = greater(most, at(x, i));
      }
      parts_[n].least = least;
      parts_[n].most = most;
    });
    Vec4T<Real> least = parts_[0].least, most = parts_[0].most;
    for (const Part& part : parts_) {
      least = lesser(least, part.least);
      most = greater(most, part.most);
    }
    const Vec4T<Real> extent = most - least;
    const Real widest = std::max({extent.v[0], extent.v[1], extent.v[2]});
    origin_ = least;
    per_metre_ = 1 / std::max(reach, widest / kCells);
    std::uint32_t cells[3] = {8, 8, 8};
    for (std::uint32_t all = 8 * 8 * 8; all < bucket_count_; all *= 2) {
      const auto share = [&](int axis) { return extent.v[axis] / static_cast<Real>(cells[axis]); };
      const bool x_longest = share(0) >= share(1) && share(0) >= share(2);
      cells[x_longest ? 0 : share(1) >= share(2) ? 1 : 2] *= 2;
    }
    row_ = cells[0];
    layer_ = cells[0] * cells[1];
  }

  std::uint32_t bucket_of(const Vec4T<Real>& x) const {
    const Vec4T<Real> cell = per_metre_ * (x - origin_);
    // A state that has gone to infinity also gets a cell.
    const auto number = [&](int axis) {
      return static_cast<std::uint32_t>(cell.v[axis] < 2 * kCells ? cell.v[axis] : 0);
    };
    return (number(0) + row_ * number(1) + layer_ * number(2)) & (bucket_count_ - 1);
  }

  std::uint32_t* ends(std::size_t thread) {
    return thread == 0 ? starts_.data() : counts_[thread].ends.data();
  }

  /// Sorts by counting: every thread takes a share of the particles, then a share of the buckets.
  template <class At>
  void sort(const Points<Real>& x, const Points<Real>* previous, Real reach, const At& at) {
    fit_grid(x, reach, at);
    const std::size_t threads = counts_.size();
    pool_.run_parts(threads, size(), [&](std::size_t n, std::size_t begin, std::size_t end) {
      std::uint32_t* const count = ends(n);
      std::fill_n(count, bucket_count_, 0);
      for (std::size_t i = begin; i < end; ++i) ++count[buckets_[i] = bucket_of(at(x, i))];
      for (std::size_t share = 1; share < threads; ++share)
        counts_[n].before[share] = static_cast<std::uint32_t>(std::count_if(
            buckets_.data() + begin, buckets_.data() + end,
            [bound = bucket_count_ * share / threads](std::uint32_t b) { return b < bound; }));
    });
    pool_.run_parts(threads, bucket_count_,
                    [&](std::size_t share, std::size_t begin, std::size_t end) {
                      std::uint32_t sum = 0;
                      for (const Count& count : counts_) sum += count.before[share];
                      std::uint32_t* const starts = starts_.data();
                      for (std::size_t b = begin; b < end; ++b) {
                        sum += starts[b];
                        starts[b] = sum;
                        for (std::size_t n = 1; n < threads; ++n) {
                          sum += ends(n)[b];
                          ends(n)[b] = sum;
                        }
                      }
                    });
    starts_[bucket_count_] = static_cast<std::uint32_t>(size());
    pool_.run_parts(threads, size(), [&](std::size_t n, std::size_t begin, std::size_t end) {
      // Those of the first thread are the starts of the buckets in the end.
      std::uint32_t* const to = ends(n);
      for (std::size_t i = end; i-- > begin;)
        particles_[--to[buckets_[i]]] = static_cast<std::uint32_t>(i);
    });
    for_each_share([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const std::size_t i = particles_[k];
        sorted_buckets_[k] = buckets_[i];
        const Vec4T<Real> p = at(x, i);
        set(now_, k, p);
        if (previous) set(moved_, k, p - at(*previous, i));
        if (!rest_.empty()) set(at_rest_, k, rest_[i]);
        if (!comparisons_.empty() && k % kSample == 0)
          comparisons_[k / kSample] = comparisons_of(k);
      }
    });
  }

  ThreadPool& pool_;
  std::vector<std::uint32_t> particles_;       ///< bucket after bucket
  std::vector<std::uint32_t> buckets_;         ///< bucket of each particle
  std::vector<std::uint32_t> sorted_buckets_;  ///< in the order of particles_
  /// Coordinates in the order of particles_, with room for kSearchLanes more.
  Coordinates now_, moved_, at_rest_;
  std::vector<Vec4T<Real>> rest_;           ///< [particles] m; empty: no pair is ignored
  Real ignored_ = 0;                        ///< m
  std::uint32_t bucket_count_ = 8 * 8 * 8;  ///< a power of two
  std::uint32_t row_ = 8, layer_ = 64;
  Vec4T<Real> origin_{};
  Real per_metre_ = 1;
  std::vector<std::uint32_t> starts_;  ///< [bucket_count + 1]
  /// Number of comparisons of every kSample-th particle; empty if there is one part.
  std::vector<std::uint32_t> comparisons_;
  FindPairs<Real> find_pairs_;
  std::vector<Part> parts_;
  std::vector<Count> counts_;  ///< one for each thread
};

}  // namespace taut
