#pragma once

// Included by one file for each instruction set, which says what its lanes are. No function here
// may be shared between them: everything depends on the lane type, which is private to the file.

#include <cstring>
#include <type_traits>

#include "core/solver/simd/distance.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/lanes.hpp"
#include "core/solver/simd/neighbour_search_impl.hpp"

namespace taut {

/// The particles of one vector of an interleaved sheet, or some of them.
template <class T, int lanes, class Real>
[[gnu::always_inline]] inline Vec3T<T> load_vec3(const Real* x) {
  return {load<T>(x), load<T>(x + lanes), load<T>(x + 2 * lanes)};
}
template <class T, int lanes, class Real>
[[gnu::always_inline]] inline void store_vec3(Real* x, const Vec3T<T>& p) {
  store(x, p.x), store(x + lanes, p.y), store(x + 2 * lanes, p.z);
}

template <class T, class Real>
void verlet(const VerletStep<Real>& s, std::size_t begin, std::size_t end) {
  const T keep(s.keep), dt2(s.dt2);
  for (std::size_t i = begin; i < end; i += kGrain)
    for (std::size_t l = 0; l < kGrain; l += kWidth<T>) {
      const T x = load<T>(s.x + i + l);
      T moved = x + (keep * (x - load<T>(s.previous + i + l)) + load<T>(s.g + l));
      if (s.a) {
        moved = moved + load<T>(s.a + i + l) * dt2;
        store(s.a + i + l, T(0.0));
      }
      store(s.x + i + l, moved);
      store(s.previous + i + l, x);
    }
}

/// All links between two vectors of an interleaved sheet.
template <class T, int lanes, Projection kind, class Real, class Shares>
[[gnu::always_inline]] inline void project_vectors(Real* a, Real* b, T rest, const Shares& shares) {
  for (int l = 0; l < lanes; l += kWidth<T>) {
    Vec3T<T> x1 = load_vec3<T, lanes>(a + l), x2 = load_vec3<T, lanes>(b + l);
    project_distance<kind>(x1, x2, rest, shares(l), shares(lanes + l));
    // b first: shifted by a lane it ends one number inside the next vector, which may be a's
    store_vec3<T, lanes>(b + l, x2), store_vec3<T, lanes>(a + l, x1);
  }
}

/// The same at the end of the lanes' strips: lane l of a is linked with lane l + 1 of b.
template <class T, int lanes, Projection kind, class Real, class Shares>
[[gnu::always_inline]] inline void project_shifted(Real* a, Real* b, T rest, const Shares& shares) {
  if constexpr (kWidth<T> != lanes) {
    project_vectors<T, lanes, kind>(a, b + 1, rest, shares);
  } else {
    // Rotated in registers: an unaligned load would wait for the stores before it.
    const Vec3T<T> b0 = load_vec3<T, lanes>(b);
    Vec3T<T> x1 = load_vec3<T, lanes>(a);
    Vec3T<T> x2{b0.x.template rotated<1>(), b0.y.template rotated<1>(), b0.z.template rotated<1>()};
    project_distance<kind>(x1, x2, rest, shares(0), shares(lanes));
    store_vec3<T, lanes>(b, Vec3T<T>{x2.x.template rotated<-1>(), x2.y.template rotated<-1>(),
                                     x2.z.template rotated<-1>()});
    store_vec3<T, lanes>(a, x1);
  }
}

/// Rows [begin, end) of a Gauss-Seidel sweep over a regular sheet.
template <class T, int lanes, Projection kind, class Real>
void sweep_sheet(const SheetSweep<Real>& sweep, Real* x, int begin, int end) {
  constexpr int vector = 3 * lanes;
  visit_rows(sweep, begin, end, [&](const SheetDirection<Real>& d, int j) {
    Real* const left = x + static_cast<std::size_t>(j + d.left) * sweep.stride;
    Real* const right = x + static_cast<std::size_t>(j + d.right) * sweep.stride;
    const SheetRow<Real> row = d.row[j];
    const int vectors = sweep.vectors, columns = d.columns;
    const T rest(d.rest), equal_share(d.equal_share);
    visit_vectors(
        sweep, d, [&](int k) __attribute__((always_inline)) {
          Real* const a = left + k * vector;
          const Real* const shares = row.shares + 2 * lanes * k;
          const auto own = [&](int l) __attribute__((always_inline)) {
            return load<T>(shares + l);
          };
          if (k >= row.equal_begin && k < row.equal_end)
            project_vectors<T, lanes, kind>(
                a, right + (k + columns) * vector,
                rest, [&](int) __attribute__((always_inline)) { return equal_share; });
          else if (k + columns < vectors)
            project_vectors<T, lanes, kind>(a, right + (k + columns) * vector, rest, own);
          else
            project_shifted<T, lanes, kind>(a, right + (k + columns - vectors) * vector, rest, own);
        });
  });
}

/// One link after the other: batches for a machine without lanes.
template <Projection kind, class Real>
[[gnu::always_inline]] inline void batches_one_by_one(const BatchRun<Real>& run, Real* x) {
  for (std::size_t n = 0; n < run.count; ++n) {
    const Batch<Real>& batch = run.batches[n];
    for (int l = 0; l < kLanes; ++l) {
      Real *a = x + batch.a[l], *b = x + batch.b[l];
      Vec3T<Real> x1{a[0], a[1], a[2]}, x2{b[0], b[1], b[2]};
      const Real* const shares = run.shares ? run.shares + 2 * kLanes * n + l : nullptr;
      project_distance<kind>(x1, x2, batch.rest[l], shares ? shares[0] : run.equal_share,
                             shares ? shares[kLanes] : run.equal_share);
      a[0] = x1.x, a[1] = x1.y, a[2] = x1.z;
      b[0] = x2.x, b[1] = x2.y, b[2] = x2.z;
    }
  }
}

inline constexpr std::uint32_t kPacked[8] = {0, 4, 8, 12, 16, 20, 24, 28};

/// T holds the x y z 0 of one particle, or of two.
template <class T, class Real>
[[gnu::always_inline]] inline T load_particles(const Real* x, const std::uint32_t* slot) {
  if constexpr (kWidth<T> == 4)
    return load<T>(x + slot[0]);
  else
    return T::join(load<typename T::Half>(x + slot[0]), load<typename T::Half>(x + slot[4]));
}
template <class T, class Real>
[[gnu::always_inline]] inline void store_particles(Real* x, const std::uint32_t* slot, T t) {
  if constexpr (kWidth<T> == 4)
    store(x + slot[0], t);
  else
    store(x + slot[0], t.lower()), store(x + slot[4], t.upper());
}

/// The x, y and z of 4 or 8 particles: lane l is that of p[l % 4], of its half l / 4.
template <class T>
[[gnu::always_inline]] inline Vec3T<T> transposed(const T (&p)[4]) {
  if constexpr (kWidth<T> == 4) {
    const T xy01 = T::template shuffle<0, 4, 1, 5>(p[0], p[1]);
    const T xy23 = T::template shuffle<0, 4, 1, 5>(p[2], p[3]);
    const T z01 = T::template shuffle<2, 6, 3, 7>(p[0], p[1]);
    const T z23 = T::template shuffle<2, 6, 3, 7>(p[2], p[3]);
    return {T::template shuffle<0, 1, 4, 5>(xy01, xy23),
            T::template shuffle<2, 3, 6, 7>(xy01, xy23), T::template shuffle<0, 1, 4, 5>(z01, z23)};
  } else {
    const T xy01 = T::template shuffle<0, 8, 1, 9, 4, 12, 5, 13>(p[0], p[1]);
    const T xy23 = T::template shuffle<0, 8, 1, 9, 4, 12, 5, 13>(p[2], p[3]);
    const T z01 = T::template shuffle<2, 10, 3, 11, 6, 14, 7, 15>(p[0], p[1]);
    const T z23 = T::template shuffle<2, 10, 3, 11, 6, 14, 7, 15>(p[2], p[3]);
    return {T::template shuffle<0, 1, 8, 9, 4, 5, 12, 13>(xy01, xy23),
            T::template shuffle<2, 3, 10, 11, 6, 7, 14, 15>(xy01, xy23),
            T::template shuffle<0, 1, 8, 9, 4, 5, 12, 13>(z01, z23)};
  }
}
/// The way back.
template <class T>
[[gnu::always_inline]] inline void transpose(const Vec3T<T>& t, T (&p)[4]) {
  const T none(0.0);
  if constexpr (kWidth<T> == 4) {
    const T xy01 = T::template shuffle<0, 4, 1, 5>(t.x, t.y);
    const T xy23 = T::template shuffle<2, 6, 3, 7>(t.x, t.y);
    const T z01 = T::template shuffle<0, 4, 1, 5>(t.z, none);
    const T z23 = T::template shuffle<2, 6, 3, 7>(t.z, none);
    p[0] = T::template shuffle<0, 1, 4, 5>(xy01, z01);
    p[1] = T::template shuffle<2, 3, 6, 7>(xy01, z01);
    p[2] = T::template shuffle<0, 1, 4, 5>(xy23, z23);
    p[3] = T::template shuffle<2, 3, 6, 7>(xy23, z23);
  } else {
    const T xy01 = T::template shuffle<0, 8, 1, 9, 4, 12, 5, 13>(t.x, t.y);
    const T xy23 = T::template shuffle<2, 10, 3, 11, 6, 14, 7, 15>(t.x, t.y);
    const T z01 = T::template shuffle<0, 8, 1, 9, 4, 12, 5, 13>(t.z, none);
    const T z23 = T::template shuffle<2, 10, 3, 11, 6, 14, 7, 15>(t.z, none);
    p[0] = T::template shuffle<0, 1, 8, 9, 4, 5, 12, 13>(xy01, z01);
    p[1] = T::template shuffle<2, 3, 10, 11, 6, 7, 14, 15>(xy01, z01);
    p[2] = T::template shuffle<0, 1, 8, 9, 4, 5, 12, 13>(xy23, z23);
    p[3] = T::template shuffle<2, 3, 10, 11, 6, 7, 14, 15>(xy23, z23);
  }
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

/// Calls f with 0, 1, 2 and 3 as constants, so that arrays of four stay in registers.
template <class F>
[[gnu::always_inline]] inline void four_times(const F& f) {
  f(std::integral_constant<int, 0>{}), f(std::integral_constant<int, 1>{});
  f(std::integral_constant<int, 2>{}), f(std::integral_constant<int, 3>{});
}

/// Links g .. g + kWidth<T> - 1 of a batch; shares null: all are equal_share.
template <class T, Projection kind, bool equal, class Real>
[[gnu::always_inline]] inline void project_batch(const Batch<Real>& batch, int g,
                                                 const Real* shares, T equal_share, Real* x) {
  T x1[4], x2[4], delta[4], squared[4];
  four_times([&](auto l) {
    x1[l] = load_particles<T>(x, batch.a + g + l);
    x2[l] = load_particles<T>(x, batch.b + g + l);
    delta[l] = x2[l] - x1[l];
    squared[l] = delta[l] * delta[l];
  });
  const T f = excess<kind>(sums(squared), load<T>(batch.rest + g));
  if constexpr (equal) {
    const T share = equal_share * f;
    four_times([&](auto l) {
      const T moved = spread<l>(share) * delta[l];
      store_particles(x, batch.a + g + l, x1[l] + moved);
      store_particles(x, batch.b + g + l, x2[l] - moved);
    });
  } else {
    const T share1 = load<T>(shares + g) * f, share2 = load<T>(shares + kLanes + g) * f;
    four_times([&](auto l) {
      store_particles(x, batch.a + g + l, x1[l] + spread<l>(share1) * delta[l]);
      store_particles(x, batch.b + g + l, x2[l] - spread<l>(share2) * delta[l]);
    });
  }
}

/// Batches with T holding a particle (4 lanes) or two (8): a whole particle is one load.
template <class T, Projection kind, class Real>
void batches(const BatchRun<Real>& run, Real* x) {
  if constexpr (kWidth<T> == 1) {
    batches_one_by_one<kind>(run, x);
  } else if (run.shares) {
    for (std::size_t n = 0; n < run.count; ++n)
      for (int g = 0; g < kLanes; g += kWidth<T>)
        project_batch<T, kind, false>(run.batches[n], g, run.shares + 2 * kLanes * n, T(0.0), x);
  } else {
    const T equal_share(run.equal_share);
    for (std::size_t n = 0; n < run.count; ++n)
      for (int g = 0; g < kLanes; g += kWidth<T>)
        project_batch<T, kind, true, Real>(run.batches[n], g, nullptr, equal_share, x);
  }
}

/// What batches() loads and stores, with nothing but an addition in between.
template <class T, class Real>
void load_and_store(const BatchRun<Real>& run, Real* x) {
  const T little(static_cast<Real>(0.001));
  for (std::size_t n = 0; n < run.count; ++n) {
    const Batch<Real>& batch = run.batches[n];
    if constexpr (kWidth<T> == 1) {
      for (int l = 0; l < kLanes; ++l)
        for (unsigned axis = 0; axis < 3; ++axis)
          x[batch.a[l] + axis] += little, x[batch.b[l] + axis] -= little;
    } else {
      for (int g = 0; g < kLanes; g += kWidth<T>) {
        T x1[4], x2[4];
        four_times([&](auto l) {
          x1[l] = load_particles<T>(x, batch.a + g + l);
          x2[l] = load_particles<T>(x, batch.b + g + l);
        });
        four_times([&](auto l) {
          store_particles(x, batch.a + g + l, x1[l] + little);
          store_particles(x, batch.b + g + l, x2[l] - little);
        });
      }
    }
  }
}

/// kWidth<T> packed particles, one after the other.
template <class T, class Real>
[[gnu::always_inline]] inline Vec3T<T> load_packed(const Real* x) {
  if constexpr (kWidth<T> == 1) {
    return {x[0], x[1], x[2]};
  } else {
    T p[4];
    four_times([&](auto l) { p[l] = load_particles<T>(x, kPacked + l); });
    return transposed(p);
  }
}
template <class T, class Real>
[[gnu::always_inline]] inline void store_packed(Real* x, const Vec3T<T>& t) {
  if constexpr (kWidth<T> == 1) {
    x[0] = t.x, x[1] = t.y, x[2] = t.z;
  } else {
    T p[4];
    transpose(t, p);
    four_times([&](auto l) { store_particles(x, kPacked + l, p[l]); });
  }
}

/// Whether a particle moved.
template <bool continuous, class Contact, class T>
[[gnu::always_inline]] inline bool collide_points(const Contact& contact, Vec3T<T>& x,
                                                  const Vec3T<T>& previous) {
  if constexpr (continuous)
    return any(contact.project_continuous(x, previous));
  else
    return any(contact.project(x, previous));
}

/// kWidth<T> particles at once, interleaved or packed.
template <class T, bool continuous, class Real, template <class> class SurfaceOf>
void collide(const Contact<Real, SurfaceOf>& contact, const ParticleSpan<Real>& span) {
  constexpr std::size_t step = kWidth<T>;
  const std::size_t lanes = span.lanes;
  const bool packed = lanes == 1;
  const auto load_vec = [&](const Real* r) __attribute__((always_inline)) {
    return packed ? load_packed<T>(r)
                  : Vec3T<T>{load<T>(r), load<T>(r + lanes), load<T>(r + 2 * lanes)};
  };
  Real last_x[4 * step] = {}, last_previous[4 * step] = {};
  std::size_t first = 0, lane = 0;
  for (std::size_t left = span.count * lanes; left > 0; left -= left < step ? left : step) {
    Real* at = span.x + first;
    const Real* previous = span.previous + first;
    if (left < step) {  // packed particles at the end go through a buffer
      std::memcpy(last_x, at, 4 * left * sizeof(Real));
      std::memcpy(last_previous, previous, 4 * left * sizeof(Real));
      at = last_x, previous = last_previous;
    }
    Vec3T<T> x = load_vec(at);
    if (collide_points<continuous>(contact, x, load_vec(previous))) {
      if (packed)
        store_packed(at, x);
      else
        store(at, x.x), store(at + lanes, x.y), store(at + 2 * lanes, x.z);
    }
    if (left < step) std::memcpy(span.x + first, last_x, 4 * left * sizeof(Real));
    first += packed ? 4 * step : step, lane += step;
    if (!packed && lane == lanes) first += 2 * lanes, lane = 0;
  }
}

template <class T, Projection kind, class Real>
Real in_registers(Real rest, int rounds, int& projections) {
  constexpr int pairs = 4;
  const T r(rest), half(0.5);
  Vec3T<T> a[pairs], b[pairs];
  four_times([&](auto i) {
    const T start(static_cast<Real>(i));
    a[i] = {start, start, start}, b[i] = {start + r, start + r, start};
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
/// of them where they collide.
template <class Real, class Narrow, class Wide, class P>
constexpr Kernels<Real> make_kernels() {
  constexpr Projection exact = Projection::exact, sqrt_free = Projection::sqrt_free;
  return {
      verlet<Narrow, Real>,
      verlet<Wide, Real>,
      {sweep_sheet<Narrow, kNarrow, exact, Real>, sweep_sheet<Narrow, kNarrow, sqrt_free, Real>},
      {sweep_sheet<Wide, kWide, exact, Real>, sweep_sheet<Wide, kWide, sqrt_free, Real>},
      {batches<P, exact, Real>, batches<P, sqrt_free, Real>},
      {.plane = collide<P, false, Real, PlaneSurface>,
       .ball = collide<P, false, Real, BallSurface>,
       .ball_continuous = collide<P, true, Real, BallSurface>,
       .box = collide<P, false, Real, BoxSurface>,
       .box_continuous = collide<P, true, Real, BoxSurface>},
      find_pairs<Narrow, Real>,
      in_registers<Wide, sqrt_free, Real>,
      load_and_store<P, Real>};
}

}  // namespace taut
