#pragma once

#include <array>
#include <span>
#include <vector>

namespace taut {

/// y = factor x^exponent.
struct PowerLaw {
  double factor = 0;
  double exponent = 0;
  double error = 0;  ///< one standard error of the exponent; 0 with two points
};
/// Least-squares line through (log x, log y). Preconditions: equal sizes >= 2, all values > 0, not
/// all x equal.
PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y);

/// Least-squares p, q in y_{n+1} = p y_n + q y_{n-1}: exact for one oscillating mode, whose roots
/// are those of z^2 - p z - q = 0. Precondition: at least four values.
std::array<double, 2> two_term_recurrence(const std::vector<double>& y);

/// Where a continuous function changes sign between a and b, to `tolerance`; f(a) and f(b) differ
/// in sign.
template <class F>
double sign_change(double a, double b, double tolerance, const F& f) {
  const bool positive = f(a) > 0;
  while (b - a > tolerance) {
    const double middle = (a + b) / 2;
    ((f(middle) > 0) == positive ? a : b) = middle;
  }
  return (a + b) / 2;
}

}  // namespace taut
