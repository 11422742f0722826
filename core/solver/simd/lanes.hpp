#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "core/solver/simd/vectors.hpp"

namespace taut {

/// One decision per lane: all bits of a lane, or no bits. && and || evaluate both sides.
template <class Real, int width, class Isa>
struct LaneMask {
  using Bits = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
  using V [[gnu::vector_size(width * sizeof(Real))]] = Bits;
  V v;

  [[gnu::always_inline]] friend LaneMask operator&&(LaneMask a, LaneMask b) { return {a.v & b.v}; }
  [[gnu::always_inline]] friend LaneMask operator||(LaneMask a, LaneMask b) { return {a.v | b.v}; }
  [[gnu::always_inline]] LaneMask operator!() const { return {~v}; }

  /// A bit for each lane, the first lane in the lowest bit.
  [[gnu::always_inline]] friend unsigned bits(LaneMask a) {
#if defined(__AVX512F__)
    if constexpr (sizeof(V) == 64 && width == 16)
      return _mm512_test_epi32_mask(__m512i(a.v), __m512i(a.v));
    if constexpr (sizeof(V) == 64 && width == 8)
      return _mm512_test_epi64_mask(__m512i(a.v), __m512i(a.v));
#endif
#if defined(__AVX__)
    if constexpr (sizeof(V) == 32 && width == 8) return unsigned(_mm256_movemask_ps(__m256(a.v)));
    if constexpr (sizeof(V) == 32 && width == 4) return unsigned(_mm256_movemask_pd(__m256d(a.v)));
#endif
#if defined(__x86_64__)
    if constexpr (sizeof(V) == 16 && width == 4) return unsigned(_mm_movemask_ps(__m128(a.v)));
    if constexpr (sizeof(V) == 16 && width == 2) return unsigned(_mm_movemask_pd(__m128d(a.v)));
#endif
    unsigned all = 0;
    for (int l = 0; l < width; ++l) all |= unsigned(a.v[l] & 1) << l;
    return all;
  }
  [[gnu::always_inline]] friend bool any(LaneMask a) { return bits(a) != 0; }
};

/// `width` numbers that are computed together. The arithmetic is that of a number, lane by lane, so
/// every width gives the same bits. `Isa` separates the code of one instruction set from that of
/// another: without it the linker might run AVX-512 code on a machine that lacks it.
template <class Real, int width, class Isa>
struct Lanes {
  using V [[gnu::vector_size(width * sizeof(Real))]] = Real;
  V v;

  Lanes() = default;
  [[gnu::always_inline]] explicit Lanes(V values) : v(values) {}
  template <class Number>
  requires std::is_arithmetic_v<Number>
  [[gnu::always_inline]] explicit Lanes(Number all) : v(static_cast<Real>(all) - V{}) {}

  [[gnu::always_inline]] friend Lanes operator+(Lanes a, Lanes b) { return Lanes(a.v + b.v); }
  [[gnu::always_inline]] friend Lanes operator-(Lanes a, Lanes b) { return Lanes(a.v - b.v); }
  [[gnu::always_inline]] friend Lanes operator*(Lanes a, Lanes b) { return Lanes(a.v * b.v); }
  [[gnu::always_inline]] friend Lanes operator/(Lanes a, Lanes b) { return Lanes(a.v / b.v); }
  using Mask = LaneMask<Real, width, Isa>;
  [[gnu::always_inline]] friend Mask operator<(Lanes a, Lanes b) { return {a.v < b.v}; }
  [[gnu::always_inline]] friend Mask operator>(Lanes a, Lanes b) { return {a.v > b.v}; }
  [[gnu::always_inline]] friend Mask operator<=(Lanes a, Lanes b) { return {a.v <= b.v}; }
  [[gnu::always_inline]] friend Mask operator>=(Lanes a, Lanes b) { return {a.v >= b.v}; }
  [[gnu::always_inline]] friend Lanes select(Mask mask, Lanes yes, Lanes no) {
    return Lanes(mask.v ? yes.v : no.v);
  }
  [[gnu::always_inline]] void operator+=(Lanes b) { v += b.v; }
  [[gnu::always_inline]] void operator-=(Lanes b) { v -= b.v; }

  /// Lane l of the result is element index[l] of the two arguments taken one after the other.
  template <int... index>
  [[gnu::always_inline]] static Lanes shuffle(Lanes a, Lanes b) {
    return Lanes(__builtin_shufflevector(a.v, b.v, index...));
  }

  /// Lane l of the result is lane l + by, wrapping around.
  template <int by>
  [[gnu::always_inline]] Lanes rotated() const {
    return [this]<int... lane>(std::integer_sequence<int, lane...>) {
      return Lanes(__builtin_shufflevector(v, v, (lane + by + width) % width...));
    }
    (std::make_integer_sequence<int, width>{});
  }

  /// The two halves of eight lanes.
  using Half [[gnu::vector_size(width * sizeof(Real) / 2)]] = Real;
  [[gnu::always_inline]] static Lanes join(Half lower, Half upper) {
    return Lanes(__builtin_shufflevector(lower, upper, 0, 1, 2, 3, 4, 5, 6, 7));
  }
  [[gnu::always_inline]] Half lower() const { return __builtin_shufflevector(v, v, 0, 1, 2, 3); }
  [[gnu::always_inline]] Half upper() const { return __builtin_shufflevector(v, v, 4, 5, 6, 7); }

#if defined(__AVX2__)
  /// Lane l of the result is lane index[l]; for eight floats.
  [[gnu::always_inline]] Lanes permuted(__m256i index) const {
    return Lanes(V(_mm256_permutevar8x32_ps(__m256(v), index)));
  }
  [[gnu::always_inline]] static __m256i indices(const std::uint8_t (&bytes)[8]) {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(bytes)));
  }
#endif

  [[gnu::always_inline]] friend Lanes sqrt(Lanes a) {
#if defined(__x86_64__)
    constexpr bool single = sizeof(Real) == sizeof(float);
    if constexpr (sizeof(V) == 16 && single) return Lanes(V(_mm_sqrt_ps(__m128(a.v))));
    if constexpr (sizeof(V) == 16 && !single) return Lanes(V(_mm_sqrt_pd(__m128d(a.v))));
#if defined(__AVX__)
    if constexpr (sizeof(V) == 32 && single) return Lanes(V(_mm256_sqrt_ps(__m256(a.v))));
    if constexpr (sizeof(V) == 32 && !single) return Lanes(V(_mm256_sqrt_pd(__m256d(a.v))));
#endif
#if defined(__AVX512F__)
    if constexpr (sizeof(V) == 64 && single)
      return Lanes(V(_mm512_maskz_sqrt_ps(0xffff, __m512(a.v))));
    if constexpr (sizeof(V) == 64 && !single)
      return Lanes(V(_mm512_maskz_sqrt_pd(0xff, __m512d(a.v))));
#endif
#endif
  }
};

/// Number of numbers in T.
template <class T>
inline constexpr int kWidth = 1;
template <class Real, int width, class Isa>
inline constexpr int kWidth<Lanes<Real, width, Isa>> = width;

/// Whether T has permuted(), an instruction that the narrower sets lack.
template <class T>
inline constexpr bool kPermutes = false;
#if defined(__AVX2__)
template <class Isa>
inline constexpr bool kPermutes<Lanes<float, 8, Isa>> = true;
#endif

/// Loads from and stores to any address of numbers.
template <class T, class Real>
[[gnu::always_inline]] inline T load(const Real* from) {
  T t;
  std::memcpy(&t, from, sizeof t);
  return t;
}
template <class T, class Real>
[[gnu::always_inline]] inline void store(Real* to, T t) {
  std::memcpy(to, &t, sizeof t);
}

/// Calls f with 0, 1, 2 and 3 as constants, so that arrays of four stay in registers.
template <class F>
[[gnu::always_inline]] inline void four_times(const F& f) {
  f(std::integral_constant<int, 0>{});
  f(std::integral_constant<int, 1>{});
  f(std::integral_constant<int, 2>{});
  f(std::integral_constant<int, 3>{});
}

inline constexpr int kPackedLanes = 1;
inline constexpr std::uint32_t kPacked[8] = {0, 1, 2, 3, 4, 5, 6, 7};

/// The particle at a place of the packed layout.
template <class Real, class Number>
[[gnu::always_inline]] inline Real* particle(Real* x, Number place) {
  return x + 4 * static_cast<std::size_t>(place);
}
template <class Real>
[[gnu::always_inline]] inline Real* particle(Real* x, PackedSlot slot) {
  return x + slot.number;
}

/// Loads x y z 0 of one particle, or of two, into T.
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
  else {
    store(particle(x, place[0]), t.lower());
    store(particle(x, place[4]), t.upper());
  }
}

/// x, y and z of 4 or 8 particles: lane l is that of p[l % 4], in its half l / 4.
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
/// Inverse of transposed().
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
/// Loads kWidth<T> packed particles from anywhere.
template <class T, class Real, class Number>
[[gnu::always_inline]] inline Vec3T<T> gather_packed(const Real* x, const Number* place) {
  if constexpr (kWidth<T> == 1) {
    x = particle(x, *place);
    return {x[0], x[1], x[2]};
  } else {
    T p[4];
    four_times([&](auto l) { p[l] = load_particles<T>(x, place + l); });
    return transposed(p);
  }
}
/// Inverse of gather_packed().
template <class T, class Real, class Number>
[[gnu::always_inline]] inline void scatter_packed(Real* x, const Number* place,
                                                  const Vec3T<T>& to) {
  if constexpr (kWidth<T> == 1) {
    x = particle(x, *place);
    x[0] = to.x;
    x[1] = to.y;
    x[2] = to.z;
  } else {
    T p[4];
    transpose(to, p);
    four_times([&](auto l) { store_particles(x, place + l, p[l]); });
  }
}
/// Loads kWidth<T> successive particles: packed, or from one vector of an interleaved sheet.
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
    store(x, p.x);
    store(x + lanes, p.y);
    store(x + 2 * lanes, p.z);
  } else if constexpr (kWidth<T> == 1) {
    x[0] = p.x;
    x[1] = p.y;
    x[2] = p.z;
  } else {
    T q[4];
    transpose(p, q);
    four_times([&](auto l) { store_particles(x, kPacked + l, q[l]); });
  }
}

}  // namespace taut
