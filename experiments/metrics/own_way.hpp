#pragma once

#include <cstddef>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// Most free vertices of a cloth whose exact steps a metric computes.
inline constexpr std::size_t kMostFree = 2500;

/// Subtracts from the displacements [m] of all vertices until time t those of a cloth that keeps
/// its shape: the displacement of its pins or, without pins, its fall, which no solver of links can
/// miss.
void keep_own_way(const Scene&, double t, std::vector<Vec3>& ways);

}  // namespace taut
