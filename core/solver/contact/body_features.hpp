#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/model/deforming_body.hpp"
#include "core/model/index.hpp"
#include "core/model/triangle.hpp"
#include "core/model/triangle_mesh.hpp"

namespace taut {

/// How a point of a face or an edge of the cloth leaves a solid.
struct Separation {
  double length = 0;           ///< m; <= 0: the point is outside
  Vec3 normal = Vec3::Zero();  ///< unit
  TrianglePoint point;
  bool has_passed = false;  ///< the edge has passed through an edge since the substep began
};

/// Whether a piece is an edge of the cloth: a face whose last two corners are one vertex.
inline bool is_edge(const Triangle& piece) { return piece[1] == piece[2]; }

/// A straight edge that does not move: of a body, or the axis of a capsule.
struct FixedEdge {
  Vec3 from, along;  ///< m
};

/// Where the lines of an edge of the cloth and of a fixed edge are nearest to each other.
struct LinesApart {
  double on_cloth = 0, on_fixed = 0;  ///< shares
  Vec3 normal = Vec3::Zero();         ///< unit, across both, of either sign
  double height = 0;                  ///< m, height of the cloth's edge along the normal

  /// Whether these points are on both edges, ends included.
  bool meet() const { return on_cloth >= 0 && on_cloth <= 1 && on_fixed >= 0 && on_fixed <= 1; }
  void turn() {
    normal = -normal;
    height = -height;
  }
  Vec3 on(const Corners& cloth) const { return (1 - on_cloth) * cloth[0] + on_cloth * cloth[1]; }
};
inline std::optional<LinesApart> lines_apart(const Vec3& p, const Vec3& q, const FixedEdge& edge) {
  constexpr double kParallel = 1e-6;
  const Vec3 u = q - p, &e = edge.along, across = u.cross(e), r = p - edge.from;
  const double across2 = across.squaredNorm(), uu = u.squaredNorm(), ee = e.squaredNorm();
  if (!(across2 > kParallel * kParallel * uu * ee)) return {};
  LinesApart apart;
  apart.on_cloth = e.cross(r).dot(across) / across2;
  apart.on_fixed = u.cross(r).dot(across) / across2;
  apart.normal = across / std::sqrt(across2);
  apart.height = apart.normal.dot(r);
  return apart;
}

/// The first crossing of an edge of the cloth with an edge of a body, ends included. The ends of
/// the cloth's edge move straight from `before` to `now`. `first` is where the edges are when they
/// cross, `end` where they are at the end; normals point to the side from which the cloth comes.
struct Crossing {
  LinesApart first, end;
  double share = 0;  ///< of the path, at the first crossing
};
/// First crossing with an edge that does not move. Solves for the share of the path at which the
/// volume spanned by the two edges is 0: a polynomial of second degree.
inline std::optional<Crossing> first_crossing(const Corners& before, const Corners& now,
                                              const FixedEdge& edge) {
  const auto at = [&](double share, std::size_t c) {
    return Vec3(before[c] + share * (now[c] - before[c]));
  };
  const auto volume = [&](double share) {
    const Vec3 p = at(share, 0);
    return (at(share, 1) - p).cross(edge.along).dot(p - edge.from);
  };
  const double at_start = volume(0), middle = volume(0.5), at_end = volume(1);
  if (at_start == 0) return {};
  const double a = 2 * (at_start + at_end - 2 * middle), b = at_end - at_start - a;
  const double discriminant = b * b - 4 * a * at_start;
  if (discriminant < 0) return {};
  const double root = -(b + std::copysign(std::sqrt(discriminant), b)) / 2;
  double shares[] = {a != 0 ? root / a : 2, root != 0 ? at_start / root : 2};
  if (shares[1] < shares[0]) std::swap(shares[0], shares[1]);
  double side = at_start;
  for (const double share : shares) {
    if (!(share >= 0 && share <= 1)) continue;
    const double from = std::exchange(side, -side);
    auto first = lines_apart(at(share, 0), at(share, 1), edge);
    if (!first || !first->meet()) continue;
    auto end = lines_apart(now[0], now[1], edge);
    if (!end || !end->meet()) {  // it has turned away: use the lines at the crossing
      end = first;
      end->height = end->normal.dot(end->on(now) - edge.from);
    }
    for (LinesApart* lines : {&*first, &*end})
      if (from < 0) lines->turn();
    return Crossing{*first, *end, share};
  }
  return {};
}
/// First crossing with an edge of a body whose ends also move straight.
inline std::optional<Crossing> first_crossing(const MovingEdge& cloth, const MovingEdge& body) {
  for (const auto& [share, rises] : passes(cloth, body)) {
    if (share == 0) return {};
    const Vec3 from = body.end(0, share);
    auto first =
        lines_apart(cloth.end(0, share), cloth.end(1, share), {from, body.end(1, share) - from});
    if (!first || !first->meet()) continue;
    const FixedEdge at_end{body.now[0], body.now[1] - body.now[0]};
    auto end = lines_apart(cloth.now[0], cloth.now[1], at_end);
    if (!end || !end->meet()) {  // it has turned away: use the lines at the crossing
      end = first;
      end->height = end->normal.dot(end->on({cloth.now[0], cloth.now[1], cloth.now[1]}) -
                                    at_end.from - end->on_fixed * at_end.along);
    }
    for (LinesApart* lines : {&*first, &*end})
      if (rises) lines->turn();
    return Crossing{*first, *end, share};
  }
  return {};
}

/// Contact of the faces and edges of a cloth with a solid body of triangles where its vertices do
/// not touch: edges of the cloth with convex edges of the body, and faces with vertices. Everything
/// else first meets a vertex of the cloth. Each piece remembers nearby features, and looks them up
/// again only after it has moved. All in the body's frame.
class BodyFeatures {
 public:
  BodyFeatures(double thickness, std::size_t pieces) : thickness_(thickness), near_(pieces) {}

  /// State at the beginning of a substep.
  struct Before {
    Corners corners;
    const TriangleMesh* mesh = nullptr;  ///< mesh of a body that deforms; null: it is rigid
    double longest_way = 0;  ///< m, longest displacement of the body's vertices since then
  };
  /// The farthest separation from any feature. before: if not null, a piece that has since passed
  /// through a convex edge counts, too.
  Separation out_of(const TriangleMesh& mesh, std::size_t piece, bool is_edge, const Corners& now,
                    const Before* before) {
    Near& near = near_[piece];
    double moved2 = 0;
    for (std::size_t c = 0; c < (is_edge ? 2u : 3u); ++c) {
      moved2 = std::max(moved2, (now[c] - near.at[c]).squaredNorm());
      if (before) moved2 = std::max(moved2, (before->corners[c] - near.at[c]).squaredNorm());
    }
    if (!(moved2 < near.reach * near.reach)) look_up(mesh, is_edge, now, before, near);
    Separation best;
    for (const int feature : near.features) {
      const Separation out =
          is_edge ? over_edge(mesh, feature, now, before) : over_vertex(mesh, feature, now);
      if (out.length > best.length) {
        best = out;
        near.last = feature;
      }
    }
    return best;
  }

  /// Forgets which features are near: the body has changed.
  void forget() {
    for (Near& near : near_) near.reach = 0;
  }

  /// Separation of an edge from the edge that it had to leave last, however far away it is; empty
  /// if the two are no longer across each other.
  std::optional<Separation> out_of_last(const TriangleMesh& mesh, std::size_t piece,
                                        const Corners& now) const {
    const int last = near_[piece].last;
    if (last < 0) return {};
    const auto at = lines_over(mesh, last, now);
    if (!at) return {};
    return over(*at, now, false);
  }

  std::size_t bytes() const { return near_.size() * sizeof(Near); }

 private:
  /// Features that a piece can meet until it has moved by `reach`.
  struct Near {
    Corners at;
    double reach = 0;           ///< m; 0: not looked up yet
    std::vector<int> features;  ///< 3 triangle + side, or vertices
    int last = -1;              ///< feature of the last separation; negative: none
  };

  static FixedEdge edge_of(const TriangleMesh& mesh, int edge) {
    const Triangle& corners = mesh.triangles()[to_index(edge / 3)];
    const Vec3 &a = mesh.vertices()[to_index(corners[to_index(edge % 3)])],
               &b = mesh.vertices()[to_index(corners[to_index((edge % 3 + 1) % 3)])];
    return {a, b - a};
  }

  void look_up(const TriangleMesh& mesh, bool is_edge, const Corners& now, const Before* before,
               Near& near) const {
    Eigen::AlignedBox3d box;
    double side2 = 0, way2 = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      box.extend(now[c]);
      side2 = std::max(side2, (now[(c + 1) % 3] - now[c]).squaredNorm());
      if (before) way2 = std::max(way2, (before->corners[c] - now[c]).squaredNorm());
    }
    near.at = now;
    near.reach = std::max({thickness_, 0.1 * std::sqrt(side2), 2 * std::sqrt(way2)});
    near.features.clear();
    const double within = near.reach + thickness_ + (before ? before->longest_way : 0);
    box.min().array() -= within;
    box.max().array() += within;
    mesh.in_box(box, [&](int triangle) {
      for (int k = 0; k < 3; ++k)
        if (is_edge)
          add_edge(mesh, 3 * triangle + k, now, within, near.features);
        else
          add_vertex(mesh, mesh.triangles()[to_index(triangle)][to_index(k)], now, within,
                     near.features);
    });
    std::sort(near.features.begin(), near.features.end());
    near.features.erase(std::unique(near.features.begin(), near.features.end()),
                        near.features.end());
  }
  /// Adds the edge, by its number in the first of its triangles.
  static void add_edge(const TriangleMesh& mesh, int edge, const Corners& now, double within,
                       std::vector<int>& all) {
    const int beyond = mesh.beyond(edge / 3, edge % 3);
    if (beyond < 0) return;
    const FixedEdge at = edge_of(mesh, edge);
    if (!(at.along.dot(mesh.normal(edge / 3).cross(mesh.normal(beyond / 3))) >
          kFlat * at.along.norm()))
      return;
    const Capsule axis{at.from, at.from + at.along, 0};
    if (-deepest_in(axis, now).depth <= within) all.push_back(std::min(edge, beyond));
  }
  static void add_vertex(const TriangleMesh& mesh, int vertex, const Corners& now, double within,
                         std::vector<int>& all) {
    const Vec3& at = mesh.vertices()[to_index(vertex)];
    if ((closest_point(now, at).position - at).norm() <= within) all.push_back(vertex);
  }

  /// Whether a normal at a convex edge lies between the normals of its two sides.
  static bool is_between(const Vec3& normal, const Vec3& along, const Vec3& one,
                         const Vec3& other) {
    return along.dot(one.cross(normal)) >= 0 && along.dot(normal.cross(other)) >= 0;
  }

  Separation over(const LinesApart& at, const Corners& now, bool has_passed) const {
    const Vec3 weights(1 - at.on_cloth, at.on_cloth, 0);
    return {thickness_ - at.height, at.normal, {at.on(now), weights}, has_passed};
  }
  /// Sum of the normals of the two sides of an edge.
  static Vec3 outward(const TriangleMesh& mesh, int edge) {
    return mesh.normal(edge / 3) + mesh.normal(mesh.beyond(edge / 3, edge % 3) / 3);
  }
  /// The nearest points of the two edges if they are across each other, with the normal outward.
  static std::optional<LinesApart> lines_over(const TriangleMesh& mesh, int edge,
                                              const Corners& now) {
    auto at = lines_apart(now[0], now[1], edge_of(mesh, edge));
    if (!at || !at->meet()) return {};
    if (at->normal.dot(outward(mesh, edge)) < 0) at->turn();
    return at;
  }

  static std::array<Vec3, 2> ends_of(const FixedEdge& edge) {
    return {edge.from, edge.from + edge.along};
  }
  /// Normal of a triangle at a share of its path from one mesh to the other, not normalised.
  static Vec3 normal_at(const TriangleMesh& from, const TriangleMesh& to, double share,
                        int triangle) {
    Corners at;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = to_index(to.triangles()[to_index(triangle)][k]);
      at[k] = from.vertices()[v] + share * (to.vertices()[v] - from.vertices()[v]);
    }
    return (at[1] - at[0]).cross(at[2] - at[0]);
  }
  /// How the cloth's edge has passed through the body's from outside; empty if it has not.
  static std::optional<Crossing> passed(const TriangleMesh& mesh, int number, const FixedEdge& edge,
                                        const Corners& now, const Before& before) {
    const int one = number / 3, other = mesh.beyond(one, number % 3) / 3;
    std::optional<Crossing> met;
    if (!before.mesh) {
      met = first_crossing(before.corners, now, edge);
      if (met && is_between(met->first.normal, edge.along, mesh.normal(one), mesh.normal(other)))
        return met;
      return {};
    }
    const MovingEdge body{ends_of(edge_of(*before.mesh, number)), ends_of(edge)};
    met = first_crossing({{before.corners[0], before.corners[1]}, {now[0], now[1]}}, body);
    if (met && is_between(met->first.normal, body.end(1, met->share) - body.end(0, met->share),
                          normal_at(*before.mesh, mesh, met->share, one),
                          normal_at(*before.mesh, mesh, met->share, other)))
      return met;
    return {};
  }

  Separation over_edge(const TriangleMesh& mesh, int number, const Corners& now,
                       const Before* before) const {
    const FixedEdge edge = edge_of(mesh, number);
    if (before)
      if (const auto met = passed(mesh, number, edge, now, *before))
        return over(met->end, now, true);
    const auto leaves_sides_below = [&](const Vec3& normal) {
      return is_between(normal, edge.along, mesh.normal(number / 3),
                        mesh.normal(mesh.beyond(number / 3, number % 3) / 3));
    };
    const auto at = lines_over(mesh, number, now);
    if (!at || at->height >= thickness_ || !leaves_sides_below(at->normal)) return {};
    // It is inside, unless it is beyond the whole body: also test a point a little further in.
    if (at->height < 0) {
      const Vec3 way = (now[1] - now[0]).normalized(), place = at->on(now);
      const double inward = way.dot(outward(mesh, number)) > 0 ? at->height : -at->height;
      if (!is_inside_at(mesh, place, -at->height) &&
          !is_inside_at(mesh, place + inward * way, -at->height))
        return {};
    }
    return over(*at, now, false);
  }

  Separation over_vertex(const TriangleMesh& mesh, int vertex, const Corners& now) const {
    const Vec3& corner = mesh.vertices()[to_index(vertex)];
    const TrianglePoint at = closest_point(now, corner);
    if (at.weights.maxCoeff() >= 1) return {};  // contact of the cloth's vertex itself
    const Vec3 way = corner - at.position;
    const double length = way.norm();
    if (length == 0) return {thickness_, mesh.corner_normal(vertex).normalized(), at};
    if (way.dot(mesh.corner_normal(vertex)) > 0) {
      if (!is_inside_at(mesh, at.position, length)) return {};
      return {thickness_ + length, way / length, at};
    }
    return {thickness_ - length, -way / length, at};
  }

  /// Whether the point is inside, and the path out to an edge or a corner is no detour.
  static bool is_inside_at(const TriangleMesh& mesh, const Vec3& place, double way) {
    return way < kDetour * -mesh.nearest(place).distance;
  }

  static constexpr double kFlat = 1e-6;  ///< sine of the angle between sides
  double thickness_;
  std::vector<Near> near_;  ///< [pieces]
};

}  // namespace taut
