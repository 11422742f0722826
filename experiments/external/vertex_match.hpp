#pragma once

#include <string>
#include <vector>

#include "core/model/vec3.hpp"

namespace taut::external {

/// Which vertex of a file is which of the scene.
struct VertexMatch {
  std::vector<std::size_t> of_scene;  ///< [n] the file's vertex that is the scene's i-th
  double farthest = 0;                ///< m, between two that are the same
  std::string mismatch;               ///< what does not agree, a sentence; "": all do
  bool same_order() const;
};

/// Pairs the vertices that lie within `tolerance` [m] of each other: each with the one of the same
/// number if that fits for all, else each with the nearest. O(n log n) unless many vertices share
/// their x.
VertexMatch match_vertices(const std::vector<Vec3>& file, const std::vector<Vec3>& scene,
                           double tolerance);

}  // namespace taut::external
