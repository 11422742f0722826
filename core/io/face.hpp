#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/model/vec3.hpp"

namespace taut {

/// A polygon of a surface, seen along its normal (the direction of its vector area), so that its
/// corners need not lie in one plane.
class Face {
 public:
  /// corners: three or more, in order around the polygon [m].
  explicit Face(std::vector<Vec3> corners);

  /// Whether every corner turns the same way, and all of them together once around.
  bool convex() const;
  /// Whether two sides meet other than in a common corner, or the face has no normal although its
  /// corners are apart: a quad that is crossed or folded onto itself.
  bool crosses_itself() const;
  /// Triangles of corners that cover the face once and nothing outside it. The ear with the
  /// shortest cut goes first; among equal ones, the one whose tip has the least coordinates, so
  /// that the triangles do not depend on the first corner of the face. Precondition: not
  /// crosses_itself().
  std::vector<std::array<std::size_t, 3>> triangles() const;

 private:
  struct Point {
    double x = 0, y = 0;
  };
  double turn(std::size_t a, std::size_t b, std::size_t c) const;
  bool sides_meet(std::size_t i, std::size_t j) const;

  std::vector<Vec3> corners_;
  std::vector<Point> seen_;  ///< corners as seen along the normal, counter-clockwise
  double size2_ = 0;         ///< m^2, square of the longest side
  bool has_normal_ = false;
};

}  // namespace taut
