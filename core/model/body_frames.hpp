#pragma once

#include <vector>

#include "core/model/vec3.hpp"

namespace taut {

/// Where a body's vertices are in its own frame over time, known in advance: linear between the
/// frames, the first of which is at t = 0; after the last one they rest.
struct BodyFrames {
  std::vector<std::vector<Vec3>> places;  ///< [frames][n] m; two frames at least
  double fps = 0;                         ///< 1/s, > 0

  std::vector<Vec3> at(double t) const;  ///< [n] m at time t [s]
};

}  // namespace taut
