#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/model/mesh.hpp"
#include "core/model/vec3.hpp"

namespace taut {

/// The point of a surface of triangles that is nearest to a given point.
struct NearestPlace {
  double distance = 0;  ///< m; negative behind the surface
  /// Unit vector, gradient of the distance: the triangle's normal if the point is inside a triangle
  /// (or on a flat edge), otherwise along the line to the point.
  Vec3 normal = Vec3::UnitY();
  int triangle = 0;
};

/// A way out of a body over an edge or a corner is no detour up to this many times the depth.
inline constexpr double kDetour = 5;

/// Where a straight path meets a triangle.
struct MeshHit {
  double share = 0;  ///< of the path
  int triangle = 0;
  bool inward = false;  ///< against the triangle's normal
};

/// A surface of triangles in its own frame, with a tree of boxes over them. It answers what
/// surface(), first hits and metrics ask of a body (Collider's MeshBody). Corners go
/// counter-clockwise seen from outside. The sign of a distance is that of the angle-weighted
/// pseudo-normal (Baerentzen, Aanaes, Signed Distance Computation Using the Angle Weighted
/// Pseudonormal, 2005).
///
/// Answers depend only on the surface and the question: among equally near triangles the first in
/// the order of `triangles` counts.
class TriangleMesh {
 public:
  /// Preconditions: triangles refer to vertices that exist, and have an area.
  TriangleMesh(std::vector<Vec3> vertices, std::vector<Triangle> triangles);

  const std::vector<Vec3>& vertices() const { return vertices_; }  ///< [n] m
  const std::vector<Triangle>& triangles() const { return triangles_; }
  const Eigen::AlignedBox3d& box() const { return box_; }
  double reach() const { return reach_; }  ///< m, from the frame's origin to the farthest vertex
  /// Whether every edge has a triangle on either side, and these go along it in opposite
  /// directions. Solids that touch in an edge have four or more there, in turn of one direction and
  /// the other as one goes round it.
  bool closed() const { return open_edge_ < 0; }
  /// The first triangle with an edge that has no such counterpart; negative: closed.
  int open_edge() const { return open_edge_; }
  double volume() const;  ///< m^3; negative: triangles face inward
  const Vec3& normal(int triangle) const { return normals_[to_place(triangle)]; }

  /// Angle-weighted normal, not normalised. Precondition: a triangle has the vertex.
  Vec3 corner_normal(int vertex) const;
  /// Edges are numbered 3 triangle + k, from corner k of the triangle to the next. Returns the
  /// number of this edge in the triangle beyond it; negative if there is no such triangle. Where
  /// solids touch, the triangle beyond is one of the same solid.
  int beyond(int triangle, int k) const { return across_[to_place(triangle)][to_place(k)]; }

  /// Moves the vertices and keeps the triangles. Boxes and normals are recomputed, the shape of the
  /// tree is kept.
  void refit(std::vector<Vec3> vertices);

  NearestPlace nearest(const Vec3&) const;
  /// Triangles near a point that was looked up: until it has moved far, the nearest is one of them.
  struct Nearby {
    static constexpr std::size_t kMost = 4;
    Vec3 at = Vec3::Zero();
    std::array<int, kMost> triangles{};         ///< the nearest first
    std::array<double, kMost + 1> distances{};  ///< m, followed by that of the next one
    /// m, distance that it may move and stay nearest to the inside of the first one.
    double within = 0;
    double noise = 0;  ///< m, far above rounding

    /// Whether the nearest triangle to p is surely one of them.
    bool know(const Vec3& p) const {
      const double spare = (distances[kMost] - distances[0] - noise) / 2;
      return spare > 0 && (p - at).squaredNorm() < spare * spare;
    }
  };
  /// The same bits as nearest(). Looks p up in `nearby` if that is sure to know it, otherwise in
  /// the tree, and then sets `nearby` to p.
  NearestPlace nearest(const Vec3& p, Nearby& nearby) const;
  /// nearest() of a point whose nearest point is inside this triangle.
  NearestPlace above(const Vec3& p, int triangle) const {
    const Vec3& normal = normals_[to_place(triangle)];
    return inside_box({normal.dot(p - corner(triangle, 0)), normal, triangle}, p);
  }
  /// The first triangle on the path, the start included and the end excluded.
  std::optional<MeshHit> first_hit(const Vec3& from, const Vec3& to) const;
  /// All triangles on the path, in its order; the end is included.
  std::vector<MeshHit> hits(const Vec3& from, const Vec3& to) const;
  /// Calls visit(triangle) for each triangle whose box meets this box.
  template <class Visit>
  void in_box(const Eigen::AlignedBox3d& box, const Visit& visit) const;

  std::size_t bytes() const;

 private:
  static std::size_t to_place(int index) { return static_cast<std::size_t>(index); }

  /// A node of the tree; its left child is the next node.
  struct Node {
    Eigen::AlignedBox3d box;
    std::int32_t first = 0;  ///< of a leaf: index in order_; otherwise the right child
    std::int32_t count = 0;  ///< number of triangles of a leaf; 0: no leaf
  };
  static constexpr std::int32_t kLeaf = 2;     ///< most triangles in a leaf
  static constexpr std::size_t kDeepest = 64;  ///< most levels; halving 2^31 triangles takes 31

  enum class Feature { inside, edge, corner };
  struct Place {
    Vec3 point;
    Feature feature = Feature::inside;
    std::size_t which = 0;  ///< corner, or edge from this corner to the next
  };
  Place place_on(int triangle, const Vec3& p) const;
  NearestPlace seen_from(const Vec3& p, int triangle) const;
  /// Corrects points outside the box: where a body crosses itself, triangles face inward from
  /// outside, but what is outside its box is outside all the same.
  NearestPlace inside_box(const NearestPlace& place, const Vec3& p) const {
    const double noise = 1e-9 * reach_;
    if (place.distance >= -noise || !closed() || box_.squaredExteriorDistance(p) <= noise * noise)
      return place;
    return {-place.distance, -place.normal, place.triangle};
  }
  double squared_distance_of(int triangle, const Vec3& p) const {
    return (p - place_on(triangle, p).point).squaredNorm();
  }
  /// The `most` triangles nearest to p, nearest first; equally near ones in the order of
  /// `triangles`. If there are fewer: -1, at an infinite distance.
  template <std::size_t most>
  struct NearestTriangles {
    std::array<int, most> triangles;
    std::array<double, most> squares;  ///< m^2, squared distances
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

  /// An edge of a triangle with a smaller and a larger end.
  struct Side {
    int low, high;
    std::int32_t triangle;
    bool upward;  ///< the triangle goes from low to high
    std::uint8_t edge;
  };
  void join_edges();
  void join(const Side&, const Side&);
  /// Joins four or more triangles round an edge in pairs that enclose a solid. Returns false if
  /// they do not.
  bool join_round(std::span<Side> sides);
  /// Where an edge has more than two triangles: the one whose side of the edge is nearest in angle
  /// to `out`, the way from the edge to a point. Otherwise negative.
  int nearest_in_angle(int edge, const Vec3& out) const;
  /// Unit vector in the triangle, across this edge of it and away from the edge.
  Vec3 away_from_edge(int triangle, std::size_t k) const;
  void build(std::int32_t begin, std::int32_t end, std::span<const Vec3> middles);
  void make_boxes();
  void make_normals();

  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<std::int32_t, 3>> across_;  ///< see beyond()
  /// Edges with more than two triangles, each with all that are in the same place; sorted.
  std::vector<std::pair<std::int32_t, std::vector<std::int32_t>>> round_;
  std::vector<Vec3> normals_;            ///< [triangles] unit
  std::vector<Vec3> corner_normals_;     ///< [n] corner_normal(); empty: computed when asked for
  std::vector<std::int32_t> corner_at_;  ///< [n] 3 triangle + k of some triangle there
  std::vector<std::int32_t> order_;      ///< triangles in the order of the leaves
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
