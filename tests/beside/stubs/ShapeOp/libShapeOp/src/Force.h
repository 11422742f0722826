#pragma once
#include "Solver.h"

namespace ShapeOp {
struct GravityForce : Force {
  explicit GravityForce(const Vector3& f) : Force{f} {}
};
}  // namespace ShapeOp
