#pragma once

#include <cmath>
#include <type_traits>

namespace taut {

/// A point or vector; T is a number or one number per lane.
template <class T>
struct Triple {
  T x, y, z;
};

template <class T>
[[gnu::always_inline]] inline Triple<T> operator+(const Triple<T>& a, const Triple<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
[[gnu::always_inline]] inline Triple<T> operator-(const Triple<T>& a, const Triple<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
[[gnu::always_inline]] inline Triple<T> operator*(T s, const Triple<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
[[gnu::always_inline]] inline Triple<T> operator/(const Triple<T>& a, T s) {
  return {a.x / s, a.y / s, a.z / s};
}
template <class T>
[[gnu::always_inline]] inline T dot(const Triple<T>& a, const Triple<T>& b) {
  return a.x * b.x + (a.y * b.y + a.z * b.z);
}
template <class T>
[[gnu::always_inline]] inline T squared_norm(const Triple<T>& a) {
  return dot(a, a);
}
template <class T>
[[gnu::always_inline]] inline T norm(const Triple<T>& a) {
  using std::sqrt;
  return sqrt(squared_norm(a));
}

// Decisions, lane by lane: a bool is the mask of a number. Lanes bring masks of their own; && and
// || of those evaluate both sides, so a text for any width divides by nothing that may be zero.
[[gnu::always_inline]] inline bool any(bool mask) { return mask; }
[[gnu::always_inline]] inline unsigned bits(bool mask) { return mask ? 1 : 0; }
template <class Real>
requires std::is_arithmetic_v<Real>
[[gnu::always_inline]] inline Real select(bool mask, Real yes, Real no) { return mask ? yes : no; }
template <class Mask, class T>
[[gnu::always_inline]] inline Triple<T> select(const Mask& mask, const Triple<T>& yes,
                                               const Triple<T>& no) {
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

/// The same in every lane.
template <class T, class Real>
[[gnu::always_inline]] inline Triple<T> spread_out(const Triple<Real>& a) {
  return {T(a.x), T(a.y), T(a.z)};
}

}  // namespace taut
