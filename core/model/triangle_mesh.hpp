#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/model/mesh.hpp"
#include "core/model/vec3.hpp"

namespace taut {

/// The place of a triangle surface that is nearest to a point.
struct NearestPlace {
  double distance = 0;  ///< m; negative behind the surface
  /// Unit, the gradient of the distance: the triangle's where the place is within one (and across
  /// edges that are flat), else along the line to the place.
  Vec3 normal = Vec3::UnitY();
  int triangle = 0;
};

/// Where a straight path meets a triangle.
struct MeshHit {
  double share = 0;  ///< of the path
  int triangle = 0;
  bool inward = false;  ///< against the triangle's normal
};

/// A surface of triangles in its own frame with a tree of boxes over them: what surface(), first
/// hits and metrics ask of a body (Collider's MeshBody). Corners go round counter-clockwise seen
/// from outside. The sign of a distance is that of the angle-weighted pseudo-normal (Baerentzen,
/// Aanaes, Signed Distance Computation Using the Angle Weighted Pseudonormal, 2005).
///
/// Answers depend on the surface and the question alone: of equally near triangles the first in
/// the order of `triangles` counts.
class TriangleMesh {
 public:
  /// Precondition: triangles name vertices that exist and have an area.
  TriangleMesh(std::vector<Vec3> vertices, std::vector<Triangle> triangles);

  const std::vector<Vec3>& vertices() const { return vertices_; }  ///< [n] m
  const std::vector<Triangle>& triangles() const { return triangles_; }
  const Eigen::AlignedBox3d& box() const { return box_; }
  double reach() const { return reach_; }  ///< m, from its frame's origin to the farthest vertex
  /// No edge without a triangle on either side, which go along it in opposite directions.
  bool closed() const { return open_edge_ < 0; }
  /// The first triangle with an edge that has no fellow; negative: closed.
  int open_edge() const { return open_edge_; }
  double volume() const;  ///< m^3; negative: triangles look inward
  const Vec3& normal(int triangle) const { return normals_[to_place(triangle)]; }

  /// Angle-weighted, of no particular length. Precondition: a triangle has the vertex.
  Vec3 corner_normal(int vertex) const;
  /// Edges are numbered 3 triangle + k, from its corner k to the next. The number of this one in
  /// the triangle beyond it; negative: there is none.
  int beyond(int triangle, int k) const { return across_[to_place(triangle)][to_place(k)]; }

  /// The vertices move, triangles stay: boxes and normals are made anew, the tree's shape is kept.
  void refit(std::vector<Vec3> vertices);

  NearestPlace nearest(const Vec3&) const;
  /// Triangles near a point that has been looked up: while it has hardly moved, the nearest is one
  /// of them.
  struct Nearby {
    static constexpr std::size_t kMost = 4;
    Vec3 at = Vec3::Zero();
    std::array<int, kMost> triangles{};         ///< the nearest first
    std::array<double, kMost + 1> distances{};  ///< m, and that of the next one
    double within = 0;  ///< m, so far it may move and be nearest to the inside of the first one
    double noise = 0;   ///< m, far beyond rounding

    /// Whether nearest(p, *this) is one of them.
    bool know(const Vec3& p) const {
      const double spare = (distances[kMost] - distances[0] - noise) / 2;
      return spare > 0 && (p - at).squaredNorm() < spare * spare;
    }
  };
  /// The same bits. Looks p up in `nearby` as long as that knows it, else in the tree, for which
  /// it then stands.
  NearestPlace nearest(const Vec3& p, Nearby& nearby) const;
  /// nearest() of a point whose nearest place is within this triangle.
  NearestPlace above(const Vec3& p, int triangle) const {
    const Vec3& normal = normals_[to_place(triangle)];
    return inside_box({normal.dot(p - corner(triangle, 0)), normal, triangle}, p);
  }
  /// The first triangle on the way, its start included and its end not.
  std::optional<MeshHit> first_hit(const Vec3& from, const Vec3& to) const;
  /// All of them, in the order of the way; the end is included.
  std::vector<MeshHit> hits(const Vec3& from, const Vec3& to) const;
  /// Calls visit(triangle) for each whose box meets this one.
  template <class Visit>
  void in_box(const Eigen::AlignedBox3d& box, const Visit& visit) const;

  std::size_t bytes() const;

 private:
  static std::size_t to_place(int index) { return static_cast<std::size_t>(index); }

  /// The left child of a node is the next one.
  struct Node {
    Eigen::AlignedBox3d box;
    std::int32_t first = 0;  ///< of a leaf: in order_; else the right child
    std::int32_t count = 0;  ///< of a leaf's triangles; 0: none
  };
  static constexpr std::int32_t kLeaf = 2;     ///< triangles at most
  static constexpr std::size_t kDeepest = 64;  ///< levels; halves of 2^31 triangles have 31

  enum class Feature { inside, edge, corner };
  struct Place {
    Vec3 point;
    Feature feature = Feature::inside;
    std::size_t which = 0;  ///< corner, or edge from it to the next one
  };
  Place place_on(int triangle, const Vec3& p) const;
  NearestPlace seen_from(const Vec3& p, int triangle) const;
  /// Where a body crosses itself, triangles look inward from outside: what is out of its box is
  /// outside all the same.
  NearestPlace inside_box(const NearestPlace& place, const Vec3& p) const {
    const double noise = 1e-9 * reach_;
    if (place.distance >= -noise || !closed() || box_.squaredExteriorDistance(p) <= noise * noise)
      return place;
    return {-place.distance, -place.normal, place.triangle};
  }
  double squared_distance_of(int triangle, const Vec3& p) const {
    return (p - place_on(triangle, p).point).squaredNorm();
  }
  /// The `most` triangles that are nearest to p, the nearest first, of equals the first in the
  /// order of `triangles`; fewer: -1, at an infinite distance.
  template <std::size_t most>
  struct NearestTriangles {
    std::array<int, most> triangles;
    std::array<double, most> squares;  ///< m^2, of their distances
    NearestTriangles();
    void add(int triangle, double distance2);
  };
  template <std::size_t most>
  NearestTriangles<most> nearest_triangles(const Vec3& p) const;
  double to_border(int triangle, const Vec3& p) const;
  const Vec3& corner(int triangle, std::size_t k) const {
    return vertices_[to_place(triangles_[to_place(triangle)][k])];
  }
  std::optional<MeshHit> hit(int triangle, const Vec3& from, const Vec3& way) const;
  template <class Visit>
  void along(const Vec3& from, const Vec3& to, const Visit& visit) const;

  void join_edges();
  void build(std::int32_t begin, std::int32_t end, std::span<const Vec3> middles);
  void make_boxes();
  void make_normals();

  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<std::int32_t, 3>> across_;  ///< beyond()
  std::vector<Vec3> normals_;                        ///< [triangles] unit
  std::vector<Vec3> corner_normals_;                 ///< [n] corner_normal(); empty: made if asked
  std::vector<std::int32_t> corner_at_;              ///< [n] 3 triangle + k of one there
  std::vector<std::int32_t> order_;                  ///< triangles as leaves have them
  std::vector<Node> nodes_;
  Eigen::AlignedBox3d box_;
  double reach_ = 0;
  int open_edge_ = -1;
};

template <class Visit>
void TriangleMesh::in_box(const Eigen::AlignedBox3d& box, const Visit& visit) const {
  std::array<std::int32_t, kDeepest> stack;
  std::size_t waiting = 0;
  for (std::int32_t n = 0;;) {
    const Node& node = nodes_[to_place(n)];
    const bool meets = node.box.intersects(box);
    if (meets && node.count == 0) {
      stack[waiting++] = node.first;
      ++n;
      continue;
    }
    for (std::int32_t k = 0; meets && k < node.count; ++k) {
      const int triangle = order_[to_place(node.first + k)];
      Eigen::AlignedBox3d own(corner(triangle, 0));
      own.extend(corner(triangle, 1)).extend(corner(triangle, 2));
      if (own.intersects(box)) visit(triangle);
    }
    if (waiting == 0) return;
    n = stack[--waiting];
  }
}

}  // namespace taut
