#include "core/model/bending.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/model/membrane.hpp"

namespace taut {

namespace {

using Vec2 = Eigen::Vector2d;

/// A triangle in its own plane, with the first axis along the warp, and the vertices beyond its
/// edges.
struct Patch {
  std::vector<int> vertex;  ///< the triangle's three, then those beyond
  std::vector<Vec2> at;     ///< m, from the first corner
  double area = 0;          ///< m^2
};

/// The vertices opposite to each edge a < b, one in each of its triangles.
using Opposite = std::map<std::pair<int, int>, std::vector<int>>;

Opposite opposites(const std::vector<Triangle>& triangles) {
  Opposite all;
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      all[std::minmax(t[k], t[(k + 1) % 3])].push_back(t[(k + 2) % 3]);
  return all;
}

Patch patch(const Mesh& mesh, const Triangle& t, const Opposite& opposite, const Vec3& warp) {
  const auto rest = [&](int v) -> const Vec3& { return mesh.rest[to_index(v)]; };
  const auto [along, across, area] = warp_axes({rest(t[0]), rest(t[1]), rest(t[2])}, warp);
  Patch p{.area = area};
  for (const int v : t) {
    const Vec3 d = rest(v) - rest(t[0]);
    p.vertex.push_back(v);
    p.at.emplace_back(along.dot(d), across.dot(d));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const int a = t[k], b = t[(k + 1) % 3];
    const std::vector<int>& both = opposite.at(std::minmax(a, b));
    if (both.size() < 2) continue;
    const int beyond = both[0] == t[(k + 2) % 3] ? both[1] : both[0];
    const Vec3 edge = (rest(b) - rest(a)).normalized(), d = rest(beyond) - rest(a);
    const double forward = edge.dot(d), out = (d - forward * edge).norm();
    const Vec2 e = (p.at[(k + 1) % 3] - p.at[k]).normalized();
    p.vertex.push_back(beyond);
    p.at.push_back(p.at[k] + forward * e + out * Vec2(e.y(), -e.x()));
  }
  return p;
}

/// Components [uu, vv, sqrt(2) uv] of the second derivative as combinations of the patch's
/// vertices. The offset j of a vertex beyond an edge from the plane of the triangle is linear in
/// these components h: R h = j, solved for the least h. Directions that j hardly
/// determines (six vertices near one conic) are left out.
Eigen::MatrixXd second_derivative(const Patch& p) {
  const auto squares = [](const Vec2& x) {
    return Vec3(x.x() * x.x() / 2, x.y() * x.y() / 2, x.x() * x.y() / std::sqrt(2.0));
  };
  const auto n = static_cast<Eigen::Index>(p.vertex.size()), beyond = n - 3;
  Eigen::Matrix2d sides;
  sides << p.at[1] - p.at[0], p.at[2] - p.at[0];
  Eigen::MatrixXd rows(beyond, 3), off = Eigen::MatrixXd::Zero(beyond, n);
  for (Eigen::Index k = 0; k < beyond; ++k) {
    const Vec2 x = p.at[static_cast<std::size_t>(3 + k)];
    const Vec2 share = sides.inverse() * (x - p.at[0]);
    const Vec3 row = squares(x) - share.x() * squares(p.at[1]) - share.y() * squares(p.at[2]);
    rows.row(k) = row.transpose() / row.norm();
    off(k, 0) = share.x() + share.y() - 1;
    off(k, 1) = -share.x();
    off(k, 2) = -share.y();
    off(k, 3 + k) = 1;
    off.row(k) /= row.norm();
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solved;
  solved.setThreshold(0.05);
  return solved.compute(rows).solve(off);
}

/// The element with these weights. Its vertices are sorted, and those without weight are left out;
/// it is empty if no vertex is left.
BendingElement element(const Patch& p, const Eigen::RowVectorXd& weights, double stiffness) {
  std::vector<std::pair<int, double>> parts;
  const double most = weights.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < p.vertex.size(); ++i)
    if (const double w = weights[static_cast<Eigen::Index>(i)]; std::abs(w) > 1e-9 * most)
      parts.emplace_back(p.vertex[i], w);
  std::ranges::sort(parts);
  BendingElement e{.stiffness = stiffness};
  double sum = 0;
  for (const auto& [v, w] : parts) {
    e.vertex[e.size] = v;
    e.weight[e.size++] = w;
    sum += w;
  }
  if (e.size > 0) e.weight[0] -= sum;  // exact to the last bit: a translation bends nothing
  return e;
}

/// If b is a multiple of a, merges it into a by raising a's stiffness. Returns whether it did.
bool merged(BendingElement& a, const BendingElement& b) {
  if (a.size != b.size || a.vertex != b.vertex) return false;
  const double factor = b.weight[0] / a.weight[0];
  for (std::size_t i = 1; i < a.size; ++i)
    if (std::abs(b.weight[i] - factor * a.weight[i]) > 1e-9 * std::abs(b.weight[i])) return false;
  a.stiffness += factor * factor * b.stiffness;
  return true;
}

}  // namespace

namespace {

/// Adds the elements of one triangulation, whose energy counts by `share`.
void add_bending(const Scene& scene, const std::vector<Triangle>& triangles, double share,
                 std::map<int, std::vector<std::size_t>>& beginning,
                 std::vector<BendingElement>& all) {
  const auto& [warp, weft, direction] = *scene.bending;
  const double stiffness[] = {warp, weft, std::sqrt(warp * weft)};
  const Opposite opposite = opposites(triangles);
  for (const Triangle& t : triangles) {
    const Patch p = patch(scene.mesh, t, opposite, direction);
    if (p.vertex.size() == 3) continue;
    const Eigen::MatrixXd h = second_derivative(p);
    for (Eigen::Index c = 0; c < 3; ++c) {
      if (h.row(c).cwiseAbs().maxCoeff() * p.area < 1e-9) continue;
      const BendingElement e = element(p, h.row(c), share * stiffness[c] * p.area);
      if (std::all_of(e.vertex.begin(), e.vertex.begin() + static_cast<long>(e.size),
                      [&](int v) { return is_pinned(scene, v); }))
        continue;
      auto& equal = beginning[e.vertex[0]];
      if (std::ranges::any_of(equal, [&](std::size_t i) { return merged(all[i], e); })) continue;
      equal.push_back(all.size());
      all.push_back(e);
    }
  }
}

/// The triangles of a grid with the other diagonal in each of its cells.
std::vector<Triangle> other_diagonals(const std::vector<Triangle>& triangles) {
  std::vector<Triangle> all;
  for (std::size_t k = 0; k + 1 < triangles.size(); k += 2) {
    const Triangle &a = triangles[k], &b = triangles[k + 1];
    const auto alone = [](const Triangle& of, const Triangle& other) {
      return std::ranges::find_if(
          of, [&](int v) { return std::ranges::find(other, v) == other.end(); });
    };
    const auto at = alone(a, b) - a.begin();  // corner of a that b lacks
    const int first = a[static_cast<std::size_t>(at)], last = *alone(b, a),
              next = a[static_cast<std::size_t>((at + 1) % 3)],
              before = a[static_cast<std::size_t>((at + 2) % 3)];
    all.push_back({first, next, last});
    all.push_back({first, last, before});
  }
  return all;
}

}  // namespace

std::vector<BendingElement> make_bending(const Scene& scene) {
  std::vector<BendingElement> all;
  if (!scene.bending) return all;
  std::map<int, std::vector<std::size_t>> beginning;  // elements by their first vertex
  const std::vector<Triangle>& triangles = scene.mesh.triangles;
  const bool both = scene.mesh.grid.has_value();
  add_bending(scene, triangles, both ? 0.5 : 1, beginning, all);
  if (both) add_bending(scene, other_diagonals(triangles), 0.5, beginning, all);
  return all;
}

double bending_energy(const std::vector<BendingElement>& elements, const std::vector<Vec3>& x) {
  double sum = 0;
  for (const BendingElement& e : elements)
    sum += e.stiffness / 2 * e.value([&](std::size_t v) { return x[v]; }).squaredNorm();
  return sum;
}

}  // namespace taut
