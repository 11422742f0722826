#pragma once

#include <cstring>

#include "core/solver/triple.hpp"

namespace taut {

/// x, y, z and a fourth number, at once: a packed particle as it lies in memory.
template <class Real>
struct Quad {
  using V [[gnu::vector_size(4 * sizeof(Real))]] = Real;
  V v;

  [[gnu::always_inline]] friend Quad operator+(const Quad& a, const Quad& b) { return {a.v + b.v}; }
  [[gnu::always_inline]] friend Quad operator-(const Quad& a, const Quad& b) { return {a.v - b.v}; }
  [[gnu::always_inline]] friend Quad operator*(Real s, const Quad& a) { return {s * a.v}; }
  /// Of x, y, z; the same bits as of Triples.
  [[gnu::always_inline]] friend Real dot(const Quad& a, const Quad& b) {
    const V product = a.v * b.v;
    return product[0] + (product[1] + product[2]);
  }
  [[gnu::always_inline]] friend Real squared_norm(const Quad& a) { return dot(a, a); }
  [[gnu::always_inline]] friend Quad lesser(const Quad& a, const Quad& b) {
    return {b.v < a.v ? b.v : a.v};
  }
  [[gnu::always_inline]] friend Quad greater(const Quad& a, const Quad& b) {
    return {a.v < b.v ? b.v : a.v};
  }
};

/// Where the particle at a slot is (particles.hpp); packed: `stride` is 1.
template <bool packed, class Real>
[[gnu::always_inline]] inline Quad<Real> load_quad(const Real* x, std::size_t stride) {
  Quad<Real> q;
  if constexpr (packed)
    std::memcpy(&q, x, sizeof q);
  else
    q.v = typename Quad<Real>::V{x[0], x[stride], x[2 * stride], 0};
  return q;
}
template <bool packed, class Real>
[[gnu::always_inline]] inline void store_quad(Real* x, std::size_t stride, const Quad<Real>& q) {
  if constexpr (packed)
    std::memcpy(x, &q, sizeof q);
  else
    x[0] = q.v[0], x[stride] = q.v[1], x[2 * stride] = q.v[2];
}

}  // namespace taut
