#pragma once

// Included by kernels_impl.hpp, whose rules apply here, too; compiled once for each instruction
// set.

#include <cstddef>
#include <type_traits>

#include "core/solver/simd/distance.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/lanes.hpp"

namespace taut {

/// x + y + z of each particle in d.
template <class T>
[[gnu::always_inline]] inline T sums(const T (&d)[4]) {
  const Vec3T<T> t = transposed(d);
  return t.x + t.y + t.z;
}

/// Lane l of every particle in t, spread over the particle's lanes.
template <int l, class T>
[[gnu::always_inline]] inline T spread(T t) {
  if constexpr (kWidth<T> == 4)
    return T::template shuffle<l, l, l, l>(t, t);
  else
    return T::template shuffle<l, l, l, l, l + 4, l + 4, l + 4, l + 4>(t, t);
}

/// Projects links g .. g + kWidth<T> - 1 of a batch. equal: shares(0) applies to both ends of all
/// of them.
template <class T, bool equal, class Real, class Number, class Shares, class Excess>
[[gnu::always_inline]] inline void project_batch(const Batch<Real, Number>& batch, int g, Real* x,
                                                 const Shares& shares, const Excess& excess_of) {
  if constexpr (kWidth<T> == 1) {
    Real *a = particle(x, batch.a[g]), *b = particle(x, batch.b[g]);
    Vec3T<Real> x1 = point_at<Real>(a);
    Vec3T<Real> x2 = point_at<Real>(b);
    move_ends(x1, x2, shares(g), shares(kLanes + g), excess_of);
    put_point(a, x1);
    put_point(b, x2);
    return;
  } else {
    T x1[4], x2[4], delta[4], squared[4];
    four_times([&](auto l) {
      x1[l] = load_particles<T>(x, batch.a + g + l);
      x2[l] = load_particles<T>(x, batch.b + g + l);
      delta[l] = x2[l] - x1[l];
      squared[l] = delta[l] * delta[l];
    });
    const T f = excess_of(sums(squared));
    if constexpr (equal) {
      const T share = shares(0) * f;
      four_times([&](auto l) {
        const T moved = spread<l>(share) * delta[l];
        store_particles(x, batch.a + g + l, x1[l] + moved);
        store_particles(x, batch.b + g + l, x2[l] - moved);
      });
    } else {
      const T share1 = shares(g) * f, share2 = shares(kLanes + g) * f;
      four_times([&](auto l) {
        store_particles(x, batch.a + g + l, x1[l] + spread<l>(share1) * delta[l]);
        store_particles(x, batch.b + g + l, x2[l] - spread<l>(share2) * delta[l]);
      });
    }
  }
}

/// Calls f(batch, n, x) for the n-th batch of a run; x: the particle from which its ends count.
/// Prefetches later batches and the next tile's particles, which no processor prefetches by itself
/// (0.66 of the time at 1024 x 1024, no effect in cache).
template <class Real, class F>
[[gnu::always_inline]] inline void visit_batches(const BatchRun<Real> run, Real* x, const F& f) {
  constexpr std::size_t kBatchesAhead = 8;
  const auto visit = [&](const auto* batches, Real* first) __attribute__((always_inline)) {
    for (std::size_t n = 0; n < run.count; ++n) {
      __builtin_prefetch(batches + n + kBatchesAhead);
      __builtin_prefetch(x + run.ahead + n * run.stride);
      f(batches[n], n, first);
    }
  };
  run.near ? visit(run.near, particle(x, run.first)) : visit(run.far, x);
}

/// Calls f(batch, n, x, g, equal, shares) for links g .. g + kWidth<T> - 1 of each batch, until all
/// are done. equal: a constant; ends: number of shares of a link.
template <class T, int ends, class Real, class F>
[[gnu::always_inline]] inline void visit_links(const BatchRun<Real>& run, Real* x, const F& f) {
  const Real* const all_shares = run.shares;
  const T equal_share(run.equal_share), multiplier_share(run.multiplier_share);
  if (all_shares)
    visit_batches(
        run, x, [&](const auto& batch, std::size_t n, Real* first) __attribute__((always_inline)) {
          const auto own = [from = all_shares + ends * kLanes * n](int l)
              __attribute__((always_inline)) {
            return load<T>(from + l);
          };
          for (int g = 0; g < kLanes; g += kWidth<T>) f(batch, n, first, g, std::false_type{}, own);
        });
  else
    visit_batches(
        run, x, [&](const auto& batch, std::size_t n, Real* first) __attribute__((always_inline)) {
          const auto equal =
              [ equal_share, multiplier_share ](int l) __attribute__((always_inline)) {
            return ends == 2 || l < 2 * kLanes ? equal_share : multiplier_share;
          };
          for (int g = 0; g < kLanes; g += kWidth<T>)
            f(batch, n, first, g, std::true_type{}, equal);
        });
}

/// Projects batches. T holds a particle (4 lanes) or two (8), so that a whole particle is one load.
/// On a machine without lanes, links come one after another.
template <class T, Projection kind, class Real>
void batches(const BatchRun<Real>& run, Real* x) {
  visit_links<T, 2>(
      run, x,
      [](const auto& batch, std::size_t, Real* first, int g, auto equal, const auto& shares)
          __attribute__((always_inline)) {
            const T rest = load<T>(batch.rest + g);
            project_batch<T, equal>(
                batch, g, first, shares, [rest](T length2) __attribute__((always_inline)) {
                  return excess<kind>(length2, rest);
                });
          });
}
template <class T, class Real>
void compliant_batches(const BatchRun<Real>& run, Real* x, Real keep) {
  if (!run.multipliers) return batches<T, Projection::exact>(run, x);
  visit_links<T, 3>(
      run, x,
      [ multipliers = run.multipliers, k = T(keep) ](
          const auto& batch, std::size_t n, Real* first, int g, auto equal,
          const auto& shares) __attribute__((always_inline)) {
        const T rest = load<T>(batch.rest + g);
        project_batch<T, equal>(
            batch, g, first, shares, [&](T length2) __attribute__((always_inline)) {
              T multiplier = load<T>(multipliers + kLanes * n + g) * k;
              const T f = compliant_excess(length2, rest, T(shares(2 * kLanes + g)), multiplier);
              store(multipliers + kLanes * n + g, multiplier);
              return f;
            });
      });
}

/// Loads and stores what batches() does, with only an addition in between.
template <class T, class Real>
void load_and_store(const BatchRun<Real>& run, Real* x) {
  const T little(static_cast<Real>(0.001));
  visit_batches(
      run, x, [&](const auto& batch, std::size_t, Real* first) __attribute__((always_inline)) {
        for (int g = 0; g < kLanes; g += kWidth<T>)
          if constexpr (kWidth<T> == 1) {
            Real *a = particle(first, batch.a[g]), *b = particle(first, batch.b[g]);
            for (int axis = 0; axis < 3; ++axis) {
              a[axis] += little;
              b[axis] -= little;
            }
          } else {
            T x1[4], x2[4];
            four_times([&](auto l) {
              x1[l] = load_particles<T>(first, batch.a + g + l);
              x2[l] = load_particles<T>(first, batch.b + g + l);
            });
            four_times([&](auto l) {
              store_particles(first, batch.a + g + l, x1[l] + little);
              store_particles(first, batch.b + g + l, x2[l] - little);
            });
          }
      });
}

}  // namespace taut
