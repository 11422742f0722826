#pragma once

// Included by instruction_set.cpp, which is compiled once for each of them and says what its lanes
// are. No function here may be shared between them: everything depends on the lane type, which is
// private to the file.

#include <cstring>
#include <type_traits>

#include "core/solver/simd/collide_impl.hpp"
#include "core/solver/simd/distance.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/lanes.hpp"
#include "core/solver/simd/link_forces_impl.hpp"
#include "core/solver/simd/neighbour_search_impl.hpp"
#include "core/solver/simd/panels_impl.hpp"
#include "core/solver/simd/vertex_sweep_impl.hpp"
#include "core/solver/simd/wind_impl.hpp"

namespace taut {

/// s: a copy, which no store changes.
template <class T, bool forces, class Real>
[[gnu::always_inline]] inline void integrate(const VerletStep<Real> s, std::size_t begin,
                                             std::size_t end) {
  const T keep(s.keep), dt2(s.dt2);
  for (std::size_t i = begin; i < end; i += kGrain)
#pragma GCC unroll 12
    for (std::size_t l = 0; l < kGrain; l += kWidth<T>) {
      const T x = load<T>(s.x + i + l);
      T moved = x + (keep * (x - load<T>(s.previous + i + l)) + load<T>(s.g + l));
      if constexpr (forces) {
        moved = moved + load<T>(s.a + i + l) * dt2;
        store(s.a + i + l, T(0.0));
      }
      store(s.x + i + l, moved);
      store(s.previous + i + l, x);
    }
}
template <class T, class Real>
void verlet(const VerletStep<Real>& s, std::size_t begin, std::size_t end) {
  s.a ? integrate<T, true>(s, begin, end) : integrate<T, false>(s, begin, end);
}

/// Rigid links, all alike: at(row, vector)(l) says of the lanes from l on what move_ends() asks.
template <class T, Projection kind>
struct RigidLinks {
  T rest;
  template <class Shares>
  [[gnu::always_inline]] auto at(int, int, const Shares&) const {
    return [r = rest](int) __attribute__((always_inline)) {
      return [r](T length2) __attribute__((always_inline)) { return excess<kind>(length2, r); };
    };
  }
};

/// Compliant ones, each with a multiplier.
template <class T, int lanes, class Real>
struct CompliantLinks {
  T rest, keep;
  Real* multipliers;
  int vectors;
  template <class Shares>
  [[gnu::always_inline]] auto at(int row, int vector, const Shares& shares) const {
    Real* const of_vector =
        multipliers + (static_cast<std::size_t>(row) * static_cast<std::size_t>(vectors) +
                       static_cast<std::size_t>(vector)) *
                          lanes;
    return [ r = rest, k = keep, of_vector, shares ](int l) __attribute__((always_inline)) {
      return [ r, k, at = of_vector + l, share = shares(2 * lanes + l) ](T length2)
          __attribute__((always_inline)) {
        T multiplier = load<T>(at) * k;
        const T f = compliant_excess(length2, r, share, multiplier);
        store(at, multiplier);
        return f;
      };
    };
  }
};

/// All links between two vectors of an interleaved sheet.
template <class T, int lanes, class Real, class Shares, class Excess>
[[gnu::always_inline]] inline void project_vectors(Real* a, Real* b, const Shares& shares,
                                                   const Excess& excess_of) {
  for (int l = 0; l < lanes; l += kWidth<T>) {
    Vec3T<T> x1 = load_vec3<T, lanes>(a + l), x2 = load_vec3<T, lanes>(b + l);
    move_ends(x1, x2, T(shares(l)), T(shares(lanes + l)), excess_of(l));
    // b first: shifted by a lane it ends one number inside the next vector, which may be a's
    store_vec3<T, lanes>(b + l, x2), store_vec3<T, lanes>(a + l, x1);
  }
}

/// The same at the end of the lanes' strips: lane l of a is linked with lane l + 1 of b.
template <class T, int lanes, class Real, class Shares, class Excess>
[[gnu::always_inline]] inline void project_shifted(Real* a, Real* b, const Shares& shares,
                                                   const Excess& excess_of) {
  if constexpr (kWidth<T> != lanes) {
    project_vectors<T, lanes>(a, b + 1, shares, excess_of);
  } else {
    // Rotated in registers: an unaligned load would wait for the stores before it.
    const Vec3T<T> b0 = load_vec3<T, lanes>(b);
    Vec3T<T> x1 = load_vec3<T, lanes>(a);
    Vec3T<T> x2{b0.x.template rotated<1>(), b0.y.template rotated<1>(), b0.z.template rotated<1>()};
    move_ends(x1, x2, T(shares(0)), T(shares(lanes)), excess_of(0));
    store_vec3<T, lanes>(b, Vec3T<T>{x2.x.template rotated<-1>(), x2.y.template rotated<-1>(),
                                     x2.z.template rotated<-1>()});
    store_vec3<T, lanes>(a, x1);
  }
}

/// Calls f(i) for those of [begin, end) that are of this pass of two: i and i + lag are in
/// different ones. Lag 0: for all.
template <int lag, class F>
[[gnu::always_inline]] inline void in_pass(int pass, int begin, int end, const F& f) {
  if constexpr (lag == 0)
    for (int i = begin; i < end; ++i) f(i);
  else if constexpr (lag == 1)
    for (int i = begin + ((begin ^ pass) & 1); i < end; i += 2) f(i);
  else
    for (int i = begin; i < end; ++i)
      if (i / lag % 2 == pass) f(i);
}

/// Calls f(j, at_end, vectors) for the links of rows [begin, end) of a direction in the order of
/// the sweep, where vectors(g) calls g(k) for some of the vectors of row j. Rows of a pass have no
/// particle in common, vectors of a row may: those at the end of the lanes' strips (at_end, a
/// constant) come after the others of their pass, but of all rows, so that few projections wait for
/// the one before.
template <int columns, int rows, class F>
[[gnu::always_inline]] inline void visit_direction(int all_vectors, int begin, int end,
                                                   const F& f) {
  static_assert(columns > 0 || rows > 0);
  constexpr int lag = rows == 0 ? columns : 0;  // of vectors
  const int inner = all_vectors - columns;
  for (int pass = 0; pass < 2; ++pass) {
    const auto visit = [&](auto at_end, int first, int last) __attribute__((always_inline)) {
      const auto vectors = [&](const auto& g) __attribute__((always_inline)) {
        in_pass<lag>(pass, first, last, g);
      };
      const auto row = [&](int j) __attribute__((always_inline)) { f(j, at_end, vectors); };
      in_pass<rows>(pass, begin, end, row);
    };
    visit(std::false_type{}, 0, inner);
    if constexpr (columns > 0) visit(std::true_type{}, inner, all_vectors);
  }
}

/// Calls f(columns, rows, direction) for each: how far its links reach, as constants.
template <class Real, class F>
[[gnu::always_inline]] inline void visit_directions(const SheetSweep<Real>& sweep, const F& f) {
  constexpr std::integral_constant<int, 0> none;
  constexpr std::integral_constant<int, 1> one;
  constexpr std::integral_constant<int, 2> two;
  for (int n = 0; n < sweep.directions; ++n) {
    const SheetDirection<Real>& d = sweep.direction[n];
    if (d.left == 0 && d.right == 0)
      d.columns == 1 ? f(one, none, d) : f(two, none, d);
    else if (d.columns == 0)
      d.right == 1 ? f(none, one, d) : f(none, two, d);
    else
      f(one, one, d);
  }
}

/// Rows [begin, end) of the links of one direction; ends: shares of a link. By itself, so that what
/// it needs stays in registers.
template <class T, int lanes, int ends, int columns, int rows, class Links, class Real>
[[gnu::noinline]] void sweep_direction(const SheetDirection<Real> d, const Links links,
                                       Real* const x, int vectors, std::size_t stride, int begin,
                                       int end) {
  constexpr int vector = 3 * lanes;
  const T equal_share(d.equal_share), multiplier_share(d.multiplier_share);
  visit_direction<columns, rows>(
      vectors, begin, end < d.rows ? end : d.rows,
      [&](int j, auto at_end, const auto& some) __attribute__((always_inline)) {
        Real* const left = x + static_cast<std::size_t>(j + d.left) * stride;
        Real* const right = x + static_cast<std::size_t>(j + d.right) * stride + columns * vector;
        const Real* const shares = d.row[j].shares;
        const auto own = [&](int k) __attribute__((always_inline)) {
          return [from = shares + ends * lanes * k](int l) __attribute__((always_inline)) {
            return load<T>(from + l);
          };
        };
        const auto equal = [ equal_share, multiplier_share ](int l) __attribute__((always_inline)) {
          return ends == 2 || l < 2 * lanes ? equal_share : multiplier_share;
        };
        if constexpr (at_end)
          some([&](int k) __attribute__((always_inline)) {
            project_shifted<T, lanes>(left + k * vector, right + (k - vectors) * vector, own(k),
                                      links.at(j, k, own(k)));
          });
        else if (d.row[j].all_equal)
          some([&](int k) __attribute__((always_inline)) {
            project_vectors<T, lanes>(left + k * vector, right + k * vector, equal,
                                      links.at(j, k, equal));
          });
        else
          some([&](int k) __attribute__((always_inline)) {
            project_vectors<T, lanes>(left + k * vector, right + k * vector, own(k),
                                      links.at(j, k, own(k)));
          });
      });
}

/// Rows [begin, end) of a Gauss-Seidel sweep over a regular sheet.
template <class T, int lanes, Projection kind, class Real>
void sweep_sheet(const SheetSweep<Real>& sweep, Real* x, int begin, int end) {
  visit_directions(sweep, [&](auto columns, auto rows, const SheetDirection<Real>& d) {
    sweep_direction<T, lanes, 2, columns, rows>(d, RigidLinks<T, kind>{T(d.rest)}, x, sweep.vectors,
                                                sweep.stride, begin, end);
  });
}
template <class T, int lanes, class Real>
void sweep_compliant_sheet(const SheetSweep<Real>& sweep, Real* x, Real keep, int begin, int end) {
  visit_directions(sweep, [&](auto columns, auto rows, const SheetDirection<Real>& d) {
    if (d.multipliers)
      sweep_direction<T, lanes, 3, columns, rows>(
          d, CompliantLinks<T, lanes, Real>{T(d.rest), T(keep), d.multipliers, sweep.vectors}, x,
          sweep.vectors, sweep.stride, begin, end);
    else
      sweep_direction<T, lanes, 2, columns, rows>(d, RigidLinks<T, Projection::exact>{T(d.rest)}, x,
                                                  sweep.vectors, sweep.stride, begin, end);
  });
}

/// x + y + z of each.
template <class T>
[[gnu::always_inline]] inline T sums(const T (&d)[4]) {
  const Vec3T<T> t = transposed(d);
  return t.x + t.y + t.z;
}

/// Lane l of every particle in t.
template <int l, class T>
[[gnu::always_inline]] inline T spread(T t) {
  if constexpr (kWidth<T> == 4)
    return T::template shuffle<l, l, l, l>(t, t);
  else
    return T::template shuffle<l, l, l, l, l + 4, l + 4, l + 4, l + 4>(t, t);
}

/// Links g .. g + kWidth<T> - 1 of a batch. equal: shares(0) is that of both ends of all of them.
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
/// Meanwhile the batches after it and the next tile's particles come from memory: no machine sees
/// by itself that these will be needed (0.66 of the time at 1024 x 1024, nothing in cache).
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

/// Calls f(batch, n, x, g, equal, shares) for all links g .. g + kWidth<T> - 1 of each; `equal` is
/// a constant, ends: shares of a link.
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

/// Batches with T holding a particle (4 lanes) or two (8): a whole particle is one load. On a
/// machine without lanes one link after the other.
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

/// What batches() loads and stores, with nothing but an addition in between.
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

template <class Narrow, class Wide, class P, Projection kind, class Real>
void tethers(const ParticleSpan<Real>& span_in, std::span<const TetherTable<Real>> tables) {
  const ParticleSpan<Real> span = span_in;  // a copy, which no store changes
  with_lanes<Narrow, Wide, P>(
      span, [&](auto t, auto of_layout) __attribute__((always_inline)) {
        using T = decltype(t);
        constexpr int lanes = of_layout;
        // Table after table: a particle's second tether waits for its first, and meanwhile there is
        // more to do for other particles. Packed ones would have to be transposed each time.
        const std::size_t at_once = lanes == kPackedLanes ? tables.size() : 1;
        std::span<const TetherTable<Real>> some;
        const auto one = [&](std::size_t at, const auto&) __attribute__((always_inline)) {
          Vec3T<T> x = load_vec3<T, lanes>(span.x + at);
          bool moved = false;
          for (const TetherTable<Real>& table : some) {
            Vec3T<T> pin = load_vec3<T, lanes>(table.pin + at), end = x;
            const T length = load_vec3<T, lanes>(table.length + at).x;
            const Vec3T<T> way = end - pin;  // summed as project_distance sums: computed once
            const auto tight = way.x * way.x + way.y * way.y + way.z * way.z > length * length;
            if (!any(tight)) continue;
            project_distance<kind>(pin, end, length, T(0), T(1));
            x = select(tight, end, x);
            moved = true;
          }
          if (moved) store_vec3<T, lanes>(span.x + at, x);
        };
        for (std::size_t n = 0; n < tables.size(); n += at_once) {
          some = tables.subspan(n, at_once);
          visit_particles<T, lanes>(span, 0, span.parts(), one);
        }
      });
}

/// What one lane after the other makes of `all`.
template <class T, class Real, class F>
[[gnu::always_inline]] inline Real over_lanes(const T& all, const F& f) {
  Real numbers[kWidth<T>];
  std::memcpy(numbers, &all, sizeof numbers);
  Real result = numbers[0];
  for (int l = 1; l < kWidth<T>; ++l) result = f(result, numbers[l]);
  return result;
}

/// Of packed particles, x y z 0 after x y z 0: as they lie there, in vectors of whole particles.
template <class T, class Real>
MotionBox<Real> packed_motion_box(const ParticleSpan<Real>& span, const Real* then,
                                  std::size_t begin, std::size_t end) {
  const Real* const x = span.x;
  const std::size_t last = 4 * span.particles - kWidth<T>;  // what is seen twice changes nothing
  const std::size_t part_end = 4 * kLanes * end;
  T least = load<T>(x) - load<T>(then), most = least;
  for (std::size_t i = 4 * kLanes * begin; i < part_end && i < last + kWidth<T>; i += kWidth<T>) {
    const std::size_t at = i < last ? i : last;
    const T moved = load<T>(x + at) - load<T>(then + at);
    least = lesser(least, moved);
    most = greater(most, moved);
  }
  Real low[kWidth<T>], high[kWidth<T>];
  std::memcpy(low, &least, sizeof low), std::memcpy(high, &most, sizeof high);
  for (int l = 4; l < kWidth<T>; ++l) {
    low[l % 4] = lesser(low[l % 4], low[l]);
    high[l % 4] = greater(high[l % 4], high[l]);
  }
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

template <class Narrow, class Wide, class P, class Real>
MotionBoxes<Real> motion_boxes(const ParticleSpan<Real>& span, const Real* then, std::size_t begin,
                               std::size_t end) {
  if constexpr (kWidth<P> >= 4)
    if (span.sheet.lanes == kPackedLanes && 4 * span.particles >= kWidth<P>)
      return {packed_motion_box<P>(span, span.previous, begin, end),
              packed_motion_box<P>(span, then, begin, end)};
  MotionBoxes<Real> boxes{};
  with_lanes<Narrow, Wide, P>(
      span, [&](auto t, auto of_layout) __attribute__((always_inline)) {
        using T = decltype(t);
        constexpr int lanes = of_layout;
        const auto first = [&](const Real* from) __attribute__((always_inline)) {
          const auto moved = [&](int axis) { return T(span.x[axis * lanes] - from[axis * lanes]); };
          return Vec3T<T>{moved(0), moved(1), moved(2)};
        };
        const Vec3T<T> starts[2] = {first(span.previous), first(then)};
        Vec3T<T> least[2] = {starts[0], starts[1]}, most[2] = {starts[0], starts[1]};
        const auto one = [&](std::size_t at, const auto& present) __attribute__((always_inline)) {
          const Vec3T<T> x = load_vec3<T, lanes>(span.x + at);
          const auto add = [&](int k, const Real* from) __attribute__((always_inline)) {
            const Vec3T<T> m = select(present, x - load_vec3<T, lanes>(from + at), starts[k]);
            least[k] = {lesser(least[k].x, m.x), lesser(least[k].y, m.y), lesser(least[k].z, m.z)};
            most[k] = {greater(most[k].x, m.x), greater(most[k].y, m.y), greater(most[k].z, m.z)};
          };
          add(0, span.previous);
          add(1, then);
        };
        visit_particles<T, lanes>(span, begin, end, one);
        const auto low = [](const T& all) { return over_lanes<T, Real>(all, lesser<Real>); };
        const auto high = [](const T& all) { return over_lanes<T, Real>(all, greater<Real>); };
        const auto box = [&](int k) -> MotionBox<Real> {
          return {{low(least[k].x), low(least[k].y), low(least[k].z)},
                  {high(most[k].x), high(most[k].y), high(most[k].z)}};
        };
        boxes = {box(0), box(1)};
      });
  return boxes;
}

template <class Narrow, class Wide, class P, class Real>
Real largest_motion2(const ParticleSpan<Real>& span, const Vec3T<Real>& middle, std::size_t begin,
                     std::size_t end) {
  Real largest = 0;
  with_lanes<Narrow, Wide, P>(
      span, [&](auto t, auto of_layout) __attribute__((always_inline)) {
        using T = decltype(t);
        constexpr int lanes = of_layout;
        T most(0);
        const auto one = [&](std::size_t at, const auto& present) __attribute__((always_inline)) {
          const Vec3T<T> moved =
              load_vec3<T, lanes>(span.x + at) - load_vec3<T, lanes>(span.previous + at);
          most = greater(most, select(present, squared_norm(moved - spread_out<T>(middle)), T(0)));
        };
        visit_particles<T, lanes>(span, begin, end, one);
        largest = over_lanes<T, Real>(most, greater<Real>);
      });
  return largest;
}

template <class T, Projection kind, class Real>
Real in_registers(Real rest, int rounds, int& projections) {
  constexpr int pairs = 4;
  const T r(rest), half(0.5);
  Vec3T<T> a[pairs], b[pairs];
  four_times([&](auto i) {
    const T start(static_cast<Real>(i));
    a[i] = {start, start, start};
    b[i] = {start + r, start + r, start};
  });
  for (int n = 0; n < rounds; ++n)
    four_times([&](auto i) { project_distance<kind>(a[i], b[i], r, half, half); });
  projections = pairs * rounds * kWidth<T>;
  T sum(0.0);
  four_times([&](auto i) { sum += a[i].x + b[i].y; });
  Real first;
  std::memcpy(&first, &sum, sizeof first);
  return first;
}

/// Narrow and Wide compute on interleaved sheets of 8 and 16 lanes, P on packed particles, and all
/// of them where they collide; Double on matrices.
template <class Real, class Narrow, class Wide, class P, class Double>
constexpr Kernels<Real> make_kernels() {
  constexpr Projection exact = Projection::exact, sqrt_free = Projection::sqrt_free;
  return {
      .narrow_verlet = verlet<Narrow, Real>,
      .wide_verlet = verlet<Wide, Real>,
      .narrow_sheet = {sweep_sheet<Narrow, kNarrow, exact, Real>,
                       sweep_sheet<Narrow, kNarrow, sqrt_free, Real>},
      .wide_sheet = {sweep_sheet<Wide, kWide, exact, Real>,
                     sweep_sheet<Wide, kWide, sqrt_free, Real>},
      .batches = {batches<P, exact, Real>, batches<P, sqrt_free, Real>},
      .compliant_narrow_sheet = sweep_compliant_sheet<Narrow, kNarrow, Real>,
      .compliant_wide_sheet = sweep_compliant_sheet<Wide, kWide, Real>,
      .compliant_batches = compliant_batches<P, Real>,
      .collide =
          {.plane = collide_aligned_or_not<Narrow, Wide, P, false, Real, PlaneSurface,
                                           LevelPlaneSurface>,
           .ball = collide<Narrow, Wide, P, false, Real, BallSurface>,
           .ball_continuous = collide<Narrow, Wide, P, true, Real, BallSurface>,
           .box =
               collide_aligned_or_not<Narrow, Wide, P, false, Real, BoxSurface, AlignedBoxSurface>,
           .box_continuous =
               collide_aligned_or_not<Narrow, Wide, P, true, Real, BoxSurface, AlignedBoxSurface>,
           .capsule = collide<Narrow, Wide, P, false, Real, CapsuleSurface>,
           .capsule_continuous = collide<Narrow, Wide, P, true, Real, CapsuleSurface>},
      .narrow_wind = wind_on_sheet<Narrow, kNarrow, Real>,
      .wide_wind = wind_on_sheet<Wide, kWide, Real>,
      .wind_on_faces = wind_on_faces<P, Real>,
      .sweep_springs = sweep_vertices<P, SpringSlot<Real>, Real>,
      .sweep_augmented = sweep_vertices<P, AugmentedSlot<Real>, Real>,
      .begin_augmented = begin_augmented<P, Real>,
      .augment = augment<P, Real>,
      .spring_forces = forces<P, SpringSlot<Real>, Real>,
      .multiplier_forces = forces<P, MultiplierSlot<Real>, Real>,
      .accelerate = accelerate<P, Real>,
      .eliminate = eliminate<Double>,
      .solve_panels = solve_panels<Double>,
      .tethers = {tethers<Narrow, Wide, P, exact, Real>, tethers<Narrow, Wide, P, sqrt_free, Real>},
      .motion_boxes = motion_boxes<Narrow, Wide, P, Real>,
      .largest_motion2 = largest_motion2<Narrow, Wide, P, Real>,
      .find_pairs = find_pairs<Narrow, Real>,
      .in_registers = in_registers<Wide, sqrt_free, Real>,
      .load_and_store = load_and_store<P, Real>};
}

}  // namespace taut
