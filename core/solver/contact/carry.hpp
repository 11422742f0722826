#pragma once

#include "core/model/collider.hpp"

namespace taut {

/// Where a collider takes the points that are fixed to it during one step. Friction and the swept
/// test see a particle's motion relative to the collider: x - carry(previous).
template <class Real>
class Carry {
 public:
  using Point = Eigen::Matrix<Real, 3, 1>;

  /// From time t to t + dt [s].
  Carry(const Motion& motion, double t, double dt) : moves_(!motion.at_rest()) {
    if (!moves_) return;
    const Eigen::Matrix3d turn =
        (motion.rotation(t + dt) * motion.rotation(t).conjugate()).toRotationMatrix();
    turn_ = turn.cast<Real>();
    shift_ = (motion.pivot + motion.displacement(t + dt) -
              turn * (motion.pivot + motion.displacement(t)))
                 .cast<Real>();
  }
  Carry() = default;

  [[gnu::always_inline]] Point operator()(const Point& p) const {
    return moves_ ? Point(turn_ * p + shift_) : p;
  }

 private:
  bool moves_ = false;
  Eigen::Matrix<Real, 3, 3> turn_;
  Point shift_;
};

}  // namespace taut
