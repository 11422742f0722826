// Our stand-in for ShapeOp: the names that our adapter uses, and a solver that does nothing useful.
#pragma once
#include <Eigen/Dense>
#include <memory>
#include <vector>

namespace ShapeOp {
using Matrix3X = Eigen::Matrix3Xd;
using Vector3 = Eigen::Vector3d;
struct Constraint {
  std::vector<int> indices;
};
struct Force {
  Vector3 gravity;
};

class Solver {
 public:
  int addConstraint(const std::shared_ptr<Constraint>& one) {
    constraints_.push_back(one);
    return static_cast<int>(constraints_.size()) - 1;
  }
  int addForces(const std::shared_ptr<Force>& one) {
    force_ = one;
    return 0;
  }
  void setPoints(const Matrix3X& points) { points_ = points; }
  const Matrix3X& getPoints() { return points_; }
  bool initialize(bool, double, double, double dt) {
    dt_ = dt;
    return true;
  }
  bool solve(unsigned iterations) {
    points_.colwise() += dt_ * dt_ * force_->gravity;
    for (unsigned i = 0; i < iterations; ++i)
      for (const auto& one : constraints_)
        points_.col(one->indices.front()) += 1e-9 * points_.col(one->indices.back());
    return true;
  }

 private:
  Matrix3X points_;
  std::vector<std::shared_ptr<Constraint>> constraints_;
  std::shared_ptr<Force> force_;
  double dt_ = 0;
};
}  // namespace ShapeOp
