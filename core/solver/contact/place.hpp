#pragma once

#include "core/model/collider.hpp"
#include "core/solver/contact/contact.hpp"

namespace taut {

// Between the model and the numbers of the contact loops, which know no Eigen.

template <class Real, class Vector>
Triple<Real> triple(const Vector& v) {
  return {static_cast<Real>(v.x()), static_cast<Real>(v.y()), static_cast<Real>(v.z())};
}
template <class Real>
Eigen::Matrix<Real, 3, 1> point(const Triple<Real>& t) {
  return {t.x, t.y, t.z};
}

template <class Real>
PlaneSurface<Real> surface_of(const Plane& plane) {
  return {triple<Real>(plane.normal), static_cast<Real>(plane.offset)};
}
template <class Real>
BallSurface<Real> surface_of(const Ball& ball) {
  return {triple<Real>(ball.center), static_cast<Real>(ball.radius)};
}
template <class Real>
BoxSurface<Real> surface_of(const Box& box) {
  const Eigen::Matrix3d axes = box.rotation.toRotationMatrix();
  return {triple<Real>(box.center),
          triple<Real>(box.half_extents),
          {triple<Real>(axes.col(0)), triple<Real>(axes.col(1)), triple<Real>(axes.col(2))},
          static_cast<Real>(box.half_extents.norm())};
}

/// From time t to t + dt [s].
template <class Real>
Carry<Real> carry_of(const Motion& motion, double t, double dt) {
  if (motion.at_rest()) return {};
  const Eigen::Matrix3d turn =
      (motion.rotation(t + dt) * motion.rotation(t).conjugate()).toRotationMatrix();
  const Vec3 shift =
      motion.pivot + motion.displacement(t + dt) - turn * (motion.pivot + motion.displacement(t));
  return {true,
          {triple<Real>(turn.row(0).transpose()), triple<Real>(turn.row(1).transpose()),
           triple<Real>(turn.row(2).transpose())},
          triple<Real>(shift)};
}

/// A collider of one kind, step after step.
template <class Real, template <class> class SurfaceOf>
class ColliderInMotion {
 public:
  ColliderInMotion(const Collider& collider, double thickness)
      : collider_(collider), thickness_(thickness) {}

  /// As the step [t, t + dt] sees it.
  Contact<Real, SurfaceOf> at(double t, double dt) const {
    return {
        surface_of<Real>(std::get<typename SurfaceOf<Real>::Shape>(shape_at(collider_, t + dt))),
        carry_of<Real>(collider_.motion, t, dt), static_cast<Real>(thickness_),
        static_cast<Real>(collider_.friction)};
  }

 private:
  Collider collider_;
  double thickness_;
};

}  // namespace taut
