#include "core/reference/elastica.hpp"

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace taut::reference {

namespace {

/// phi = pi/2 - theta, phi', reach and drop, as functions of t = 1 - s.
using Shape = Eigen::Vector4d;

Shape slope(double t, const Shape& y, double gamma, double force) {
  return {y[1], (gamma * t + force) * std::sin(y[0]), std::sin(y[0]), std::cos(y[0])};
}

/// Integrates from the free end, at the angle phi to the vertical, to the clamp or to where phi
/// exceeds pi.
Shape shot(double phi, double gamma, double force, int steps) {
  const double h = 1.0 / steps;
  Shape y(phi, 0, 0, 0);
  for (int n = 0; n < steps && y[0] < std::numbers::pi; ++n) {
    const double t = n * h;
    const Shape a = slope(t, y, gamma, force), b = slope(t + h / 2, y + h / 2 * a, gamma, force),
                c = slope(t + h / 2, y + h / 2 * b, gamma, force),
                d = slope(t + h, y + h * c, gamma, force);
    y += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return y;
}

}  // namespace

Elastica elastica(double gamma, double force, int steps) {
  double low = -600, high = std::log(std::numbers::pi / 2);  // bounds of log(phi)
  for (int k = 0; k < 100 && high - low > 1e-15 * std::abs(low); ++k) {
    const double middle = (low + high) / 2;
    const bool beyond = shot(std::exp(middle), gamma, force, steps)[0] > std::numbers::pi / 2;
    (beyond ? high : low) = middle;
  }
  const Shape clamp = shot(std::exp((low + high) / 2), gamma, force, steps);
  return {clamp[2], clamp[3], clamp[1]};
}

double bending_length(double angle) {
  double low = 1e-6, high = 1e6;  // bounds of gamma
  for (int k = 0; k < 60; ++k) {
    const double middle = std::sqrt(low * high);
    const Elastica e = elastica(middle, 0, 1000);
    (std::atan2(e.drop, e.reach) > angle ? high : low) = middle;
  }
  return std::cbrt(1 / high);
}

double peirce_bending_length(double angle) {
  return std::cbrt(std::cos(angle / 2) / (8 * std::tan(angle)));
}

}  // namespace taut::reference
