#pragma once

namespace taut {

/// Vasilovici's second listing ("the algorithm then becomes") as printed, a test double that must
/// never be used to simulate: its first line belongs to the square-root-free form and its last two
/// to the exact one, so `diff` is undefined there and, whatever it may mean, the signs push apart.
///
///     Delta *= restlength * restlength / (delta * delta + restlength * restlength) - 0.5
///     x1 += delta * 0.5 * diff;
///     x2 -= delta * 0.5 * diff;
enum class PrintedReading {
  opposite_sign,  ///< 0.5 diff = 1: the square-root-free form with the printed += and -=
  literal         ///< diff = (d - r)/d, from Vasilovici's first listing
};

/// Strain after one application to a link of unit rest length and strain e, equal masses.
inline double printed_strain(PrintedReading reading, double e) {
  const double rest = 1, d = rest + e;
  double x1 = 0, x2 = d;
  const double diff = reading == PrintedReading::literal ? (d - rest) / d : 2;
  double delta = x2 - x1;
  delta *= rest * rest / (delta * delta + rest * rest) - 0.5;
  x1 += delta * 0.5 * diff;
  x2 -= delta * 0.5 * diff;
  return (x2 - x1) / rest - 1;
}

}  // namespace taut
