#pragma once
#include "Solver.h"

namespace ShapeOp {
struct EdgeStrainConstraint : Constraint {
  EdgeStrainConstraint(const std::vector<int>& of, double, const Matrix3X&) : Constraint{of} {}
};
struct ClosenessConstraint : EdgeStrainConstraint {
  using EdgeStrainConstraint::EdgeStrainConstraint;
};
}  // namespace ShapeOp
