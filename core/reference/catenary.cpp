#include "core/reference/catenary.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace taut::reference {

namespace {

/// Root of an increasing function between a and b, to neighbouring doubles.
template <class F>
double bisect(double a, double b, const F& f) {
  for (int n = 0; n < 2000; ++n) {
    const double middle = a + (b - a) / 2;
    if (middle <= a || middle >= b) break;
    (f(middle) < 0 ? a : b) = middle;
  }
  return a + (b - a) / 2;
}

}  // namespace

double Catenary::sag() const { return -*std::min_element(y.begin(), y.end()); }

Catenary discrete_catenary(int links, double span, double link, double load, double stiffness) {
  assert(links >= 2 && load > 0 && span > 0);
  const auto slope = [&](int i, double h) { return load / h * (i + 1 - (links + 1) / 2.0); };
  const auto length = [&](int i, double h) {
    return link + h * std::hypot(1.0, slope(i, h)) / stiffness;
  };
  const auto gap = [&](double h) {
    double reach = 0;
    for (int i = 0; i < links; ++i) reach += length(i, h) / std::hypot(1.0, slope(i, h));
    return reach - span;
  };
  double high = load;
  while (gap(high) < 0) high *= 2;
  Catenary c;
  c.horizontal = bisect(0.0, high, gap);
  c.x = {0}, c.y = {0};
  for (int i = 0; i < links; ++i) {
    const double t = slope(i, c.horizontal), l = length(i, c.horizontal), secant = std::hypot(1, t);
    c.tension.push_back(c.horizontal * secant);
    c.x.push_back(c.x.back() + l / secant);
    c.y.push_back(c.y.back() + l * t / secant);
  }
  return c;
}

double continuum_sag(double length, double span) {
  // u = span/2a: sinh(u)/u = length/span
  const double u = bisect(1e-9, 700.0, [&](double v) { return std::sinh(v) / v - length / span; });
  const double a = span / (2 * u);
  return a * (std::cosh(u) - 1);
}

}  // namespace taut::reference
