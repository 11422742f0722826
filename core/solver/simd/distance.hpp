#pragma once

#include <cmath>

#include "core/solver/simd/vectors.hpp"

namespace taut {

/// How the distance constraint |x2 - x1| = rest is projected, for any masses, w = 1/m.
///
/// exact (Jakobsen 2001, section 4):          f = (|delta| - r) / |delta|
/// sqrt-free (ibid., first-order Taylor of    f = (|delta|^2 - r^2) / (|delta|^2 + r^2)
/// the root around r^2, signs corrected):
/// both:                                      x1 += w1/(w1 + w2) f delta
///                                            x2 -= w2/(w1 + w2) f delta
///
/// Vasilovici, Cloth Simulation Report, prints a mixture of the two listings whose sign is wrong;
/// see tests/solver/projection_test.cpp.
enum class Projection { exact, sqrt_free };

/// A length below that of any link [m]. It is added so that coincident particles give 0 and not
/// 0/0, and changes no other bit.
inline constexpr double kTinyLength = 1e-18;

/// The share of delta by which a pair is too long.
template <Projection kind, class T>
[[gnu::always_inline]] inline T excess(T length2, T rest) {
  if constexpr (kind == Projection::exact) {
    using std::sqrt;
    const T length = sqrt(length2 + T(kTinyLength * kTinyLength));
    return (length - rest) / length;
  } else {
    const T rest2 = rest * rest;
    return (length2 - rest2) / (length2 + rest2);
  }
}

/// XPBD's excess (Macklin, Mueller, Chentanez 2016, equations 17 and 18), as a length. With
/// a = compliance/h^2 and m = a lambda,
///
///     m -= a/(w1 + w2 + a) (|delta| - r + m),    f = (|delta| - r + m before) / |delta|,
///
/// for shares w/(w1 + w2 + a). Without compliance it equals `exact`, bit by bit.
template <class T>
[[gnu::always_inline]] inline T compliant_excess(T length2, T rest, T share, T& multiplier) {
  using std::sqrt;
  const T length = sqrt(length2 + T(kTinyLength * kTinyLength));
  const T beyond = length - rest + multiplier;
  multiplier = multiplier - share * beyond;
  return beyond / length;
}

/// Moves x1 and x2 by excess_of(|delta|^2), for every width and precision. share1 and share2 are
/// w1/(w1 + w2) and w2/(w1 + w2), times the relaxation weight of the link. Only project_batch
/// (batches_impl.hpp), whose coordinates lie across the lanes, repeats these operations.
template <class T, class Excess>
[[gnu::always_inline]] inline void move_ends(Vec3T<T>& x1, Vec3T<T>& x2, T share1, T share2,
                                             const Excess& excess_of) {
  const Vec3T<T> delta{x2.x - x1.x, x2.y - x1.y, x2.z - x1.z};
  const T f = excess_of(delta.x * delta.x + delta.y * delta.y + delta.z * delta.z);
  const T f1 = share1 * f, f2 = share2 * f;
  x1.x += f1 * delta.x;
  x1.y += f1 * delta.y;
  x1.z += f1 * delta.z;
  x2.x -= f2 * delta.x;
  x2.y -= f2 * delta.y;
  x2.z -= f2 * delta.z;
}

/// Moves x1 and x2 to the distance rest.
template <Projection kind, class T>
[[gnu::always_inline]] inline void project_distance(Vec3T<T>& x1, Vec3T<T>& x2, T rest, T share1,
                                                    T share2) {
  move_ends(
      x1, x2, share1, share2, [rest](T length2) __attribute__((always_inline)) {
        return excess<kind>(length2, rest);
      });
}

}  // namespace taut
