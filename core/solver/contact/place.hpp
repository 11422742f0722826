#pragma once

#include "core/model/collider.hpp"
#include "core/solver/contact/contact.hpp"

namespace taut {

// Between the model and the numbers of the contact loops, which know no Eigen.

PlaneSurface<double> surface_of(const Plane&);
BallSurface<double> surface_of(const Ball&);
BoxSurface<double> surface_of(const Box&);

/// From time t to t + dt [s].
Carry<double> carry_of(const Motion&, double t, double dt);

template <class Real, class Vector>
Triple<Real> triple(const Vector& v) {
  return {static_cast<Real>(v.x()), static_cast<Real>(v.y()), static_cast<Real>(v.z())};
}
template <class Real>
Eigen::Matrix<Real, 3, 1> point(const Triple<Real>& t) {
  return {t.x, t.y, t.z};
}

// The same in the solver's precision.
template <class Real>
Triple<Real> rounded(const Triple<double>& t) {
  return {static_cast<Real>(t.x), static_cast<Real>(t.y), static_cast<Real>(t.z)};
}
template <class Real>
PlaneSurface<Real> rounded(const PlaneSurface<double>& plane) {
  return {rounded<Real>(plane.normal), static_cast<Real>(plane.offset)};
}
template <class Real>
BallSurface<Real> rounded(const BallSurface<double>& ball) {
  return {rounded<Real>(ball.center), static_cast<Real>(ball.radius)};
}
template <class Real>
BoxSurface<Real> rounded(const BoxSurface<double>& box) {
  return {rounded<Real>(box.center),
          rounded<Real>(box.half),
          {rounded<Real>(box.axes[0]), rounded<Real>(box.axes[1]), rounded<Real>(box.axes[2])},
          static_cast<Real>(box.far)};
}
template <class Real>
Carry<Real> rounded(const Carry<double>& c) {
  return {c.moves,
          {rounded<Real>(c.turn[0]), rounded<Real>(c.turn[1]), rounded<Real>(c.turn[2])},
          rounded<Real>(c.shift)};
}

}  // namespace taut
