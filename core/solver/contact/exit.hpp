#pragma once

#include "core/model/collider.hpp"
#include "core/model/triangle.hpp"

namespace taut {

/// How the deepest point of a face leaves a solid.
struct Exit {
  double length = 0;           ///< m; <= 0: it is outside
  Vec3 normal = Vec3::Zero();  ///< unit
  TrianglePoint point;
};

/// Precondition: a ball or a box.
Exit way_out(const Shape&, const Corners&);

}  // namespace taut
