#pragma once

#include <array>
#include <vector>

namespace taut {

/// Least-squares line through (log x, log y): y ~ x^value.
struct Slope {
  double value = 0;
  double error = 0;      ///< one standard error; 0 with two points
  double intercept = 0;  ///< log y at x = 1
};
/// Preconditions: equal sizes >= 2, all values > 0, not all x equal.
Slope log_slope(const std::vector<double>& x, const std::vector<double>& y);

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
