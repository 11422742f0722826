#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace taut {

/// A point or vector; T is a number, or one number per lane.
template <class T>
struct Vec3T {
  T x, y, z;
};

/// The point whose three numbers follow one another at `at`.
template <class T>
[[gnu::always_inline]] inline Vec3T<T> point_at(const T* at) {
  return {at[0], at[1], at[2]};
}
template <class T>
[[gnu::always_inline]] inline void put_point(T* at, const Vec3T<T>& p) {
  at[0] = p.x;
  at[1] = p.y;
  at[2] = p.z;
}

template <class T>
[[gnu::always_inline]] inline Vec3T<T> operator+(const Vec3T<T>& a, const Vec3T<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
[[gnu::always_inline]] inline Vec3T<T> operator-(const Vec3T<T>& a, const Vec3T<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
[[gnu::always_inline]] inline Vec3T<T> operator*(T s, const Vec3T<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
[[gnu::always_inline]] inline Vec3T<T> operator/(const Vec3T<T>& a, T s) {
  return {a.x / s, a.y / s, a.z / s};
}
template <class T>
[[gnu::always_inline]] inline T dot(const Vec3T<T>& a, const Vec3T<T>& b) {
  return a.x * b.x + (a.y * b.y + a.z * b.z);
}
template <class T>
[[gnu::always_inline]] inline T squared_norm(const Vec3T<T>& a) {
  return dot(a, a);
}
template <class T>
[[gnu::always_inline]] inline T norm(const Vec3T<T>& a) {
  using std::sqrt;
  return sqrt(squared_norm(a));
}

// Decisions, lane by lane: a bool is the mask of a number. Lanes have masks of their own, whose &&
// and || evaluate both sides, so code for any width must not divide by what may be zero.
[[gnu::always_inline]] inline bool any(bool mask) { return mask; }
[[gnu::always_inline]] inline unsigned bits(bool mask) { return mask ? 1 : 0; }
template <class Real>
requires std::is_arithmetic_v<Real>
[[gnu::always_inline]] inline Real select(bool mask, Real yes, Real no) { return mask ? yes : no; }
template <class Mask, class T>
[[gnu::always_inline]] inline Vec3T<T> select(const Mask& mask, const Vec3T<T>& yes,
                                              const Vec3T<T>& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
template <class T>
[[gnu::always_inline]] inline T greater(T a, T b) {
  return select(a < b, b, a);
}
template <class T>
[[gnu::always_inline]] inline T lesser(T a, T b) {
  return select(b < a, b, a);
}
template <class T>
[[gnu::always_inline]] inline T magnitude(T a) {
  return select(a < T(0), T(0) - a, a);
}

/// The same point in every lane.
template <class T, class Real>
[[gnu::always_inline]] inline Vec3T<T> spread_out(const Vec3T<Real>& a) {
  return {T(a.x), T(a.y), T(a.z)};
}

/// x, y, z and a fourth number at once: a packed particle as it lies in memory.
template <class Real>
struct Vec4T {
  using V [[gnu::vector_size(4 * sizeof(Real))]] = Real;
  V v;

  [[gnu::always_inline]] friend Vec4T operator+(const Vec4T& a, const Vec4T& b) {
    return {a.v + b.v};
  }
  [[gnu::always_inline]] friend Vec4T operator-(const Vec4T& a, const Vec4T& b) {
    return {a.v - b.v};
  }
  [[gnu::always_inline]] friend Vec4T operator*(Real s, const Vec4T& a) { return {s * a.v}; }
  /// Over x, y, z only; the same bits as for Vec3T.
  [[gnu::always_inline]] friend Real dot(const Vec4T& a, const Vec4T& b) {
    const V product = a.v * b.v;
    return product[0] + (product[1] + product[2]);
  }
  [[gnu::always_inline]] friend Real squared_norm(const Vec4T& a) { return dot(a, a); }
  [[gnu::always_inline]] friend Vec4T lesser(const Vec4T& a, const Vec4T& b) {
    return {b.v < a.v ? b.v : a.v};
  }
  [[gnu::always_inline]] friend Vec4T greater(const Vec4T& a, const Vec4T& b) {
    return {a.v < b.v ? b.v : a.v};
  }
};

/// Index of the number that is the x of a packed particle: four times its place, so that gathering
/// has nothing to compute.
struct PackedSlot {
  std::uint32_t number;
};

/// Loads the particle at a slot (layout/particles.hpp); packed: `stride` is 1.
template <bool packed, class Real>
[[gnu::always_inline]] inline Vec4T<Real> load_vec4(const Real* x, std::size_t stride) {
  Vec4T<Real> q;
  if constexpr (packed)
    std::memcpy(&q, x, sizeof q);
  else
    q.v = typename Vec4T<Real>::V{x[0], x[stride], x[2 * stride], 0};
  return q;
}
template <bool packed, class Real>
[[gnu::always_inline]] inline void store_vec4(Real* x, std::size_t stride, const Vec4T<Real>& q) {
  if constexpr (packed)
    std::memcpy(x, &q, sizeof q);
  else {
    x[0] = q.v[0];
    x[stride] = q.v[1];
    x[2 * stride] = q.v[2];
  }
}

}  // namespace taut
