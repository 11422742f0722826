#pragma once

#include <array>

#include "core/model/collider.hpp"

namespace taut {

/// The corners of one face of the cloth [m].
using Corners = std::array<Vec3, 3>;

/// A point of a triangle: position and barycentric coordinates (non-negative, sum 1).
struct TrianglePoint {
  Vec3 position = Vec3::Zero();  ///< m
  Vec3 weights = Vec3::Zero();
};

/// The point of a triangle that is nearest to p, exact. Degenerate triangles are segments or
/// points.
TrianglePoint closest_point(const Corners&, const Vec3& p);

/// A point of a triangle and its depth below a collider's surface; depth <= 0: outside.
struct Deepest {
  double depth = 0;  ///< m
  TrianglePoint at;
};

/// The deepest point of a triangle inside a ball. Exact: the point nearest to the centre.
Deepest deepest_in(const Ball&, const Corners&);

/// The deepest point of a triangle inside a capsule. Exact: the point nearest to the axis.
Deepest deepest_in(const Capsule&, const Corners&);

/// The deepest point of a triangle inside a box, exact. Depth is the least of six linear functions,
/// so its maximum is at a corner of the triangle, on an edge where two of them are equal, or inside
/// where three are. A triangle that misses the box gets some depth <= 0. Costs a few hundred
/// operations unless `at_least` rejects it: a triangle that is provably no deeper may be reported
/// with depth = at_least and the weights of its first corner.
Deepest deepest_in(const Box&, const Corners&, double at_least = 0);

/// Error of deepest_in() of a body of triangles, as a share of the triangle's longest side.
inline constexpr double kDepthError = 0.01;

/// Depth [m] of the deepest point of a triangle in a solid body of triangles, to kDepthError of its
/// longest side, negative outside; `at_least` if it is no deeper. Both are in the body's frame. By
/// bisection: two points at distance d differ in depth by at most d, so a part that cannot be
/// deeper than the known maximum is not examined further.
double deepest_in(const TriangleMesh&, const Corners&, double at_least = 0);

/// Radius of the smallest ball around a triangle [m]: that of its circumscribed circle or, if it is
/// obtuse, half its longest edge.
double enclosing_radius(const Corners&);

/// True if the triangles cross: an edge of one passes through the inside of the other. Touching and
/// overlap within one plane do not count.
bool cross(const Corners&, const Corners&);

/// Length [m] of the line along which two triangles cross, between the two points where an edge of
/// one passes through the inside of the other; 0 if they do not cross.
double crossing_length(const Corners&, const Corners&);

/// Distance of two triangles that do not cross [m]; 0 where they touch or overlap.
double distance(const Corners&, const Corners&);

}  // namespace taut
