#pragma once

#include <vector>

#include "core/model/vec3.hpp"

namespace taut {

/// Known motion of a body's vertices in the body's own frame: linear between frames, the first of
/// which is at t = 0, and at rest after the last.
struct BodyFrames {
  /// [frames][n] m; at least two frames.
  std::vector<std::vector<Vec3>> places;
  double fps = 0;  ///< 1/s, > 0

  std::vector<Vec3> at(double t) const;  ///< [n] m at time t [s]
};

}  // namespace taut
