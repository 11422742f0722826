#include "core/solver/contact/exit.hpp"

namespace taut {

namespace {

/// A point that is equally deep below several sides leaves between them, over their common edge
/// or corner: along n = sum of their normals, by depth / (n . one of them).
Exit over_edge(const Box& box, const Deepest& deepest) {
  const Vec3 local = box.rotation.conjugate() * (deepest.at.position - box.center);
  const Vec3 depths = box.half_extents - local.cwiseAbs();
  Vec3 out = Vec3::Zero();
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    if (depths[axis] <= deepest.depth * (1 + 1e-6)) out[axis] = local[axis] < 0 ? -1 : 1;
  const double sides = out.norm();  // sqrt(how many)
  if (sides == 0) return {};
  return {deepest.depth * sides, box.rotation * out / sides, deepest.at};
}

}  // namespace

Exit way_out(const Shape& shape, const Corners& t) {
  if (const Ball* ball = std::get_if<Ball>(&shape)) {
    const Deepest deepest = deepest_in(*ball, t);
    if (deepest.depth <= 0) return {};
    return {deepest.depth, surface(*ball, deepest.at.position).normal, deepest.at};
  }
  const Box& box = std::get<Box>(shape);
  const Deepest deepest = deepest_in(box, t);
  if (deepest.depth <= 0) return {};
  return over_edge(box, deepest);
}

}  // namespace taut
