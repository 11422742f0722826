#pragma once

#include <cmath>

namespace taut {

/// How the distance constraint |x2 - x1| = rest is projected; any masses, w = 1/m.
///
/// exact (Jakobsen 2001, section 4):          f = (|delta| - r) / (|delta| (w1 + w2))
/// sqrt-free (ibid., first-order Taylor of    f = (|delta|^2 - r^2) / ((|delta|^2 + r^2) (w1 + w2))
/// the root around r^2, signs corrected):
/// both:                                      x1 += w1 f delta,  x2 -= w2 f delta
///
/// The report prints a splice of the two listings whose sign is wrong; see tests/textbook_test.cpp.
enum class Projection { exact, sqrt_free };

/// f (w1 + w2) of one link: the share of delta by which the pair is too long. T is a scalar or a
/// SIMD lane type.
template <Projection kind, class T>
inline T excess(T length2, T rest, T rest2) {
  if constexpr (kind == Projection::exact) {
    using std::sqrt;
    const T length = sqrt(length2);
    return (length - rest) / length;
  } else {
    return (length2 - rest2) / (length2 + rest2);
  }
}

}  // namespace taut
