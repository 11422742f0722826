#pragma once

// Included once for each instruction set, as kernels_impl.hpp says.

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/solver/simd/lanes.hpp"
#include "core/solver/simd/vectors.hpp"

namespace taut {

/// Calls f with 0, 1, 2 and 3 as constants, so that arrays of four stay in registers.
template <class F>
[[gnu::always_inline]] inline void four_times(const F& f) {
  f(std::integral_constant<int, 0>{}), f(std::integral_constant<int, 1>{});
  f(std::integral_constant<int, 2>{}), f(std::integral_constant<int, 3>{});
}

inline constexpr int kPackedLanes = 1;
inline constexpr std::uint32_t kPacked[8] = {0, 1, 2, 3, 4, 5, 6, 7};

/// Where the particle at a place of the packed layout is.
template <class Real, class Number>
[[gnu::always_inline]] inline Real* particle(Real* x, Number place) {
  return x + 4 * static_cast<std::size_t>(place);
}

/// T holds the x y z 0 of one particle, or of two.
template <class T, class Real, class Number>
[[gnu::always_inline]] inline T load_particles(const Real* x, const Number* place) {
  if constexpr (kWidth<T> == 4)
    return load<T>(particle(x, place[0]));
  else
    return T::join(load<typename T::Half>(particle(x, place[0])),
                   load<typename T::Half>(particle(x, place[4])));
}
template <class T, class Real, class Number>
[[gnu::always_inline]] inline void store_particles(Real* x, const Number* place, T t) {
  if constexpr (kWidth<T> == 4)
    store(particle(x, place[0]), t);
  else
    store(particle(x, place[0]), t.lower()), store(particle(x, place[4]), t.upper());
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
/// kWidth<T> packed particles, wherever they are.
template <class T, class Real>
[[gnu::always_inline]] inline Vec3T<T> gather_packed(const Real* x, const std::uint32_t* place) {
  if constexpr (kWidth<T> == 1) {
    x = particle(x, *place);
    return {x[0], x[1], x[2]};
  } else {
    T p[4];
    four_times([&](auto l) { p[l] = load_particles<T>(x, place + l); });
    return transposed(p);
  }
}
/// kWidth<T> particles, one after the other: packed, or of one vector of an interleaved sheet.
template <class T, int lanes, class Real>
[[gnu::always_inline]] inline Vec3T<T> load_vec3(const Real* x) {
  if constexpr (lanes == kPackedLanes)
    return gather_packed<T>(x, kPacked);
  else
    return {load<T>(x), load<T>(x + lanes), load<T>(x + 2 * lanes)};
}
template <class T, int lanes, class Real>
[[gnu::always_inline]] inline void store_vec3(Real* x, const Vec3T<T>& p) {
  if constexpr (lanes != kPackedLanes) {
    store(x, p.x), store(x + lanes, p.y), store(x + 2 * lanes, p.z);
  } else if constexpr (kWidth<T> == 1) {
    x[0] = p.x, x[1] = p.y, x[2] = p.z;
  } else {
    T q[4];
    transpose(p, q);
    four_times([&](auto l) { store_particles(x, kPacked + l, q[l]); });
  }
}

}  // namespace taut
