#pragma once

#include <array>
#include <vector>

#include "core/model/mesh.hpp"

namespace taut {

/// Pairs of faces that cross each other and share no vertex, in ascending order. Sorts the faces
/// along the longest side of their bounding box and compares only those that overlap there.
std::vector<std::array<int, 2>> crossings(const std::vector<Triangle>&, const std::vector<Vec3>& x);

/// Length [m] of the lines along which these pairs of faces cross.
double contour_length(const std::vector<Triangle>&, const std::vector<Vec3>& x,
                      const std::vector<std::array<int, 2>>& crossings);

/// Pairs of faces that share no vertex, do not cross, and are nearer to each other than `distance`
/// [m], in ascending order. These are layers that coincide: in one plane, they cross nowhere.
std::vector<std::array<int, 2>> coincidences(const std::vector<Triangle>&,
                                             const std::vector<Vec3>& x, double distance);

/// Minimum of (distance - min(2 radius, distance at rest)) over all pairs of vertices [m], at most
/// 0: by how much balls of the given radius [m] overlap more than they do at rest.
double least_gap(const std::vector<Vec3>& x, const std::vector<Vec3>& rest, double radius);

}  // namespace taut
