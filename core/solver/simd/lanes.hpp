#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace taut {

/// One decision per lane: all bits of a lane, or none. && and || evaluate both sides.
template <class Real, int width, class Isa>
struct LaneMask {
  using Bits = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
  using V [[gnu::vector_size(width * sizeof(Real))]] = Bits;
  V v;

  [[gnu::always_inline]] friend LaneMask operator&&(LaneMask a, LaneMask b) { return {a.v & b.v}; }
  [[gnu::always_inline]] friend LaneMask operator||(LaneMask a, LaneMask b) { return {a.v | b.v}; }
  [[gnu::always_inline]] LaneMask operator!() const { return {~v}; }

  /// A bit for each lane, the first one lowest.
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

/// `width` numbers that are computed with at once. The arithmetic is a number's, lane by lane, so
/// every width gives the same bits. `Isa` keeps what one instruction set compiles to apart from
/// what another does: without it the linker might run AVX-512 code on a machine that has none.
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

  /// Lane l of the result is element l of the two arguments one after the other at index[l].
  template <int... index>
  [[gnu::always_inline]] static Lanes shuffle(Lanes a, Lanes b) {
    return Lanes(__builtin_shufflevector(a.v, b.v, index...));
  }

  /// Lane l of the result is lane l + by, around the end.
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

/// How many numbers T is.
template <class T>
inline constexpr int kWidth = 1;
template <class Real, int width, class Isa>
inline constexpr int kWidth<Lanes<Real, width, Isa>> = width;

/// From and to any address of numbers.
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

}  // namespace taut
