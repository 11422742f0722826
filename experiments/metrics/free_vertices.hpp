#pragma once

#include <algorithm>
#include <cmath>

#include "core/model/scene.hpp"

namespace taut {

/// The vertices that a solver moves, ascending.
inline std::vector<std::size_t> free_vertices(const Scene& scene) {
  std::vector<std::size_t> free;
  for (int i = 0; i < scene.mesh.size(); ++i)
    if (!std::binary_search(scene.pins.begin(), scene.pins.end(), i))
      free.push_back(static_cast<std::size_t>(i));
  return free;
}

/// Mean of |v|^2 over the given vertices [m^2/s^2].
inline double mean_square_speed(const State& state, const std::vector<std::size_t>& vertices) {
  double sum = 0;
  for (const std::size_t i : vertices) sum += state.v[i].squaredNorm();
  return sum / static_cast<double>(vertices.size());
}

}  // namespace taut
