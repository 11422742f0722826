#include "core/model/crossings.hpp"

#include <algorithm>
#include <numeric>

#include "core/model/triangle.hpp"

namespace taut {

namespace {

Eigen::Index longest_axis(const std::vector<Vec3>& x) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : x) box.extend(p);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  return axis;
}

Corners corners(const Triangle& t, const std::vector<Vec3>& x) {
  return {x[static_cast<std::size_t>(t[0])], x[static_cast<std::size_t>(t[1])],
          x[static_cast<std::size_t>(t[2])]};
}

bool share_vertex(const Triangle& s, const Triangle& t) {
  return std::any_of(s.begin(), s.end(),
                     [&](int i) { return std::find(t.begin(), t.end(), i) != t.end(); });
}

struct BoxedFace {
  Eigen::AlignedBox3d box;
  int face = 0;
};

/// Pairs of faces that share no vertex, whose boxes are nearer than `reach`, and for which `meet`
/// returns true.
template <class Meet>
std::vector<std::array<int, 2>> pairs_of(const std::vector<Triangle>& faces,
                                         const std::vector<Vec3>& x, double reach,
                                         const Meet& meet) {
  const Eigen::Index axis = longest_axis(x);
  std::vector<BoxedFace> boxed(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const Vec3& p : corners(faces[f], x)) boxed[f].box.extend(p);
    boxed[f].box.max().array() += reach;  // one side is enough: a is nearer to b, or b to a
    boxed[f].face = static_cast<int>(f);
  }
  std::sort(boxed.begin(), boxed.end(), [axis](const BoxedFace& a, const BoxedFace& b) {
    return a.box.min()[axis] < b.box.min()[axis];
  });
  std::vector<std::array<int, 2>> pairs;
  for (auto a = boxed.begin(); a != boxed.end(); ++a)
    for (auto b = a + 1; b != boxed.end() && b->box.min()[axis] <= a->box.max()[axis]; ++b) {
      if (!a->box.intersects(b->box)) continue;
      const Triangle &s = faces[static_cast<std::size_t>(a->face)],
                     &t = faces[static_cast<std::size_t>(b->face)];
      if (share_vertex(s, t) || !meet(corners(s, x), corners(t, x))) continue;
      pairs.push_back({std::min(a->face, b->face), std::max(a->face, b->face)});
    }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

std::vector<std::array<int, 2>> crossings(const std::vector<Triangle>& faces,
                                          const std::vector<Vec3>& x) {
  return pairs_of(faces, x, 0, cross);
}

double contour_length(const std::vector<Triangle>& faces, const std::vector<Vec3>& x,
                      const std::vector<std::array<int, 2>>& crossings) {
  double length = 0;
  for (const auto& [a, b] : crossings)
    length += crossing_length(corners(faces[static_cast<std::size_t>(a)], x),
                              corners(faces[static_cast<std::size_t>(b)], x));
  return length;
}

std::vector<std::array<int, 2>> coincidences(const std::vector<Triangle>& faces,
                                             const std::vector<Vec3>& x, double distance) {
  return pairs_of(faces, x, distance, [distance](const Corners& s, const Corners& t) {
    return taut::distance(s, t) < distance && !cross(s, t);
  });
}

double least_gap(const std::vector<Vec3>& x, const std::vector<Vec3>& rest, double radius) {
  const Eigen::Index axis = longest_axis(x);
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return x[a][axis] < x[b][axis]; });
  double least = 0;
  for (std::size_t k = 0; k < order.size(); ++k)
    for (std::size_t m = k + 1; m < order.size(); ++m) {
      const std::size_t a = order[k], b = order[m];
      if (x[b][axis] - x[a][axis] >= 2 * radius) break;
      const double distance = (x[b] - x[a]).norm();
      if (distance >= 2 * radius) continue;
      least = std::min(least, distance - std::min(2 * radius, (rest[b] - rest[a]).norm()));
    }
  return least;
}

}  // namespace taut
