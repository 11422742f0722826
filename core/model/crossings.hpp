#pragma once

#include <array>
#include <vector>

#include "core/model/mesh.hpp"

namespace taut {

/// Pairs of faces that cross each other and share no vertex, ascending. Sorts the faces along the
/// longest side of their bounding box, so that only those that overlap there are compared.
std::vector<std::array<int, 2>> crossings(const std::vector<Triangle>&, const std::vector<Vec3>& x);

/// Length [m] of the lines along which these pairs of faces cross.
double contour_length(const std::vector<Triangle>&, const std::vector<Vec3>& x,
                      const std::vector<std::array<int, 2>>& crossings);

/// Pairs of faces that share no vertex, do not cross, and are nearer than `distance` [m] to each
/// other, ascending: layers in one place, which cross nowhere if they lie in one plane.
std::vector<std::array<int, 2>> coincidences(const std::vector<Triangle>&,
                                             const std::vector<Vec3>& x, double distance);

/// The least of (distance - min(2 radius, distance at rest)) over all pairs of vertices [m], at
/// most 0: how far the balls of the given radius [m] overlap more than they do at rest.
double least_gap(const std::vector<Vec3>& x, const std::vector<Vec3>& rest, double radius);

}  // namespace taut
