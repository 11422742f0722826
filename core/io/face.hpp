#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/model/vec3.hpp"

namespace taut {

/// A polygon of a surface, seen along its normal (the direction of its vector area): what its
/// corners need not lie in one plane for.
class Face {
 public:
  /// Three corners or more, in order round it [m].
  explicit Face(std::vector<Vec3> corners);

  /// Every corner turns the same way, and all of them together once round.
  bool convex() const;
  /// Two of its sides meet other than in a corner that they share, or it has no normal although
  /// its corners are apart: a quad that is crossed or folded onto itself.
  bool crosses_itself() const;
  /// Triangles of corners that cover the face once, none outside of it: the ear with the shortest
  /// cut goes first, of equal ones that whose tip has the least coordinates, so that the triangles
  /// are the same whatever the corner with which the face begins. Precondition: not
  /// crosses_itself().
  std::vector<std::array<std::size_t, 3>> triangles() const;

 private:
  struct Point {
    double x = 0, y = 0;
  };
  double turn(std::size_t a, std::size_t b, std::size_t c) const;
  bool sides_meet(std::size_t i, std::size_t j) const;

  std::vector<Vec3> corners_;
  std::vector<Point> seen_;  ///< along the normal, counter-clockwise
  double size2_ = 0;         ///< of the longest side, squared [m^2]
  bool has_normal_ = false;
};

}  // namespace taut
