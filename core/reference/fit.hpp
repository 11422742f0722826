#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace taut {

/// The law y = factor x^exponent.
struct PowerLaw {
  double factor = 0;
  double exponent = 0;
  double error = 0;  ///< standard error of the exponent; 0 with two points
};
/// Least-squares line through (log x, log y). Preconditions: equal sizes >= 2, all values > 0, not
/// all x equal.
inline PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y) {
  const auto n = static_cast<double>(x.size());
  double mx = 0, my = 0, sxx = 0, sxy = 0, rest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mx += std::log(x[i]) / n;
    my += std::log(y[i]) / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - mx;
    sxx += dx * dx;
    sxy += dx * (std::log(y[i]) - my);
  }
  const double exponent = sxy / sxx, intercept = my - exponent * mx;
  for (std::size_t i = 0; i < x.size(); ++i)
    rest += std::pow(std::log(y[i]) - intercept - exponent * std::log(x[i]), 2);
  return {std::exp(intercept), exponent, n > 2 ? std::sqrt(rest / (n - 2) / sxx) : 0};
}

/// Least-squares p, q in y_{n+1} = p y_n + q y_{n-1}. Exact for one oscillating mode, whose roots
/// are those of z^2 - p z - q = 0. Precondition: at least four values.
inline std::array<double, 2> two_term_recurrence(const std::vector<double>& y) {
  double aa = 0, ab = 0, bb = 0, ac = 0, bc = 0;
  for (std::size_t n = 1; n + 1 < y.size(); ++n) {
    aa += y[n] * y[n];
    ab += y[n] * y[n - 1];
    bb += y[n - 1] * y[n - 1];
    ac += y[n] * y[n + 1];
    bc += y[n - 1] * y[n + 1];
  }
  const double det = aa * bb - ab * ab;
  return {(ac * bb - bc * ab) / det, (aa * bc - ab * ac) / det};
}

/// Where a continuous function changes sign between a and b, to `tolerance`. Precondition: f(a) and
/// f(b) differ in sign.
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
