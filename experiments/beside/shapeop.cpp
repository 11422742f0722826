// ShapeOp: projective dynamics, its own solver, factor and constraints.
#define SHAPEOP_HEADER_ONLY
#include <Constraint.h>
#include <Force.h>
#include <Solver.h>

#include <cassert>
#include <string>

#include "beside.hpp"

namespace {

class Sheet {
 public:
  explicit Sheet(const beside::Net& net) {
    ShapeOp::Matrix3X points(3, static_cast<int>(net.points.size()));
    for (std::size_t i = 0; i < net.points.size(); ++i)
      points.col(static_cast<int>(i)) =
          ShapeOp::Vector3(net.points[i].x, net.points[i].y, net.points[i].z);
    solver_.setPoints(points);
    // The energy is half of the squared weight, in units of the mass that its dynamics have.
    const double weight = std::sqrt(beside::Net::kStiffness);
    for (const auto& link : net.links)
      solver_.addConstraint(std::make_shared<ShapeOp::EdgeStrainConstraint>(
          std::vector<int>{link.a, link.b}, weight, points));
    for (const int pin : net.pins)
      solver_.addConstraint(std::make_shared<ShapeOp::ClosenessConstraint>(std::vector<int>{pin},
                                                                           100 * weight, points));
    solver_.addForces(
        std::make_shared<ShapeOp::GravityForce>(ShapeOp::Vector3(0, -beside::Net::kGravity, 0)));
    solver_.initialize(true, net.mass, 1.0, beside::Net::kStep);
  }

  void step(int iterations) { solver_.solve(static_cast<unsigned>(iterations)); }
  double lowest() { return solver_.getPoints().row(1).minCoeff(); }

 private:
  ShapeOp::Solver solver_;
};

}  // namespace

int main() { return beside::serve<Sheet>(); }
