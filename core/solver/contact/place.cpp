#include "core/solver/contact/place.hpp"

namespace taut {

PlaneSurface<double> surface_of(const Plane& plane) {
  return {triple<double>(plane.normal), plane.offset};
}

BallSurface<double> surface_of(const Ball& ball) {
  return {triple<double>(ball.center), ball.radius};
}

BoxSurface<double> surface_of(const Box& box) {
  const Eigen::Matrix3d axes = box.rotation.toRotationMatrix();
  return {triple<double>(box.center),
          triple<double>(box.half_extents),
          {triple<double>(axes.col(0)), triple<double>(axes.col(1)), triple<double>(axes.col(2))},
          box.half_extents.norm()};
}

Carry<double> carry_of(const Motion& motion, double t, double dt) {
  if (motion.at_rest()) return {};
  const Eigen::Matrix3d turn =
      (motion.rotation(t + dt) * motion.rotation(t).conjugate()).toRotationMatrix();
  const Vec3 shift =
      motion.pivot + motion.displacement(t + dt) - turn * (motion.pivot + motion.displacement(t));
  return {true,
          {triple<double>(turn.row(0).transpose()), triple<double>(turn.row(1).transpose()),
           triple<double>(turn.row(2).transpose())},
          triple<double>(shift)};
}

}  // namespace taut
