#include "core/model/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace taut {

namespace {

/// Rounding of coordinates, as a share of a body's size.
constexpr double kNoise = 1e-13;

double squared_distance(const Eigen::AlignedBox3d& box, const Vec3& p) {
  return (box.min() - p).cwiseMax(p - box.max()).cwiseMax(0).squaredNorm();
}

/// Whether the segment may meet the box after it is enlarged by `larger` on every side (Ericson,
/// Real-Time Collision Detection, 5.3.3).
bool meets(const Eigen::AlignedBox3d& box, double larger, const Vec3& middle, const Vec3& half) {
  const Vec3 reach = box.sizes() / 2 + Vec3::Constant(larger);
  const Vec3 apart = middle - box.center(), along = half.cwiseAbs();
  if (((apart.cwiseAbs() - reach - along).array() > 0).any()) return false;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Eigen::Index a = (k + 1) % 3, b = (k + 2) % 3;
    const double between = std::abs(apart[a] * half[b] - apart[b] * half[a]);
    if (between > reach[a] * along[b] + reach[b] * along[a] + larger * (along[a] + along[b]))
      return false;
  }
  return true;
}

Vec3 normal_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b - a).cross(c - a).normalized();
}

double angle_at(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// Angle-weighted normal of the triangles around a corner of one of them. Goes from that triangle
/// across edges to one side and, if they leave a gap, also to the other side.
Vec3 normal_round(int triangle, std::size_t which, std::span<const Vec3> vertices,
                  std::span<const Triangle> triangles,
                  std::span<const std::array<std::int32_t, 3>> across,
                  std::span<const Vec3> normals) {
  const auto place = [](int index) { return static_cast<std::size_t>(index); };
  const int corner = triangles[place(triangle)][which];
  const auto corner_of = [&](int t) {
    const Triangle& all = triangles[place(t)];
    return all[0] == corner ? 0u : all[1] == corner ? 1u : 2u;
  };
  const auto share = [&](int t) {
    const std::size_t k = corner_of(t);
    const auto x = [&](std::size_t n) { return vertices[place(triangles[place(t)][n % 3])]; };
    return Vec3(angle_at(x(k), x(k + 1), x(k + 2)) * normals[place(t)]);
  };
  const auto beyond = [&](int t, std::size_t edge) {
    const std::int32_t side = across[place(t)][edge % 3];
    return side < 0 ? -1 : side / 3;
  };
  Vec3 sum = share(triangle);
  for (const std::size_t edge : {2u, 0u}) {
    std::size_t seen = 1;
    for (int t = beyond(triangle, which + edge); t >= 0 && seen < triangles.size();
         t = beyond(t, corner_of(t) + edge), ++seen) {
      if (t == triangle) return sum;
      sum += share(t);
    }
  }
  return sum;
}

}  // namespace

TriangleMesh::TriangleMesh(std::vector<Vec3> vertices, std::vector<Triangle> triangles)
    : triangles_(std::move(triangles)), across_(triangles_.size(), {-1, -1, -1}) {
  vertices_ = std::move(vertices);
  corner_at_.assign(vertices_.size(), -1);
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      corner_at_[to_place(triangles_[t][k])] = static_cast<std::int32_t>(3 * t + k);
  std::vector<Vec3> middles;
  middles.reserve(triangles_.size());
  order_.reserve(triangles_.size());
  for (const Triangle& t : triangles_) {
    order_.push_back(static_cast<std::int32_t>(order_.size()));
    middles.push_back(
        (vertices_[to_place(t[0])] + vertices_[to_place(t[1])] + vertices_[to_place(t[2])]) / 3);
  }
  join_edges();
  nodes_.reserve(4 * triangles_.size() / (kLeaf + 1) + 1);
  if (!triangles_.empty()) build(0, static_cast<std::int32_t>(order_.size()), middles);
  make_boxes();
  make_normals();
}

Vec3 TriangleMesh::corner_normal(int vertex) const {
  if (!corner_normals_.empty()) return corner_normals_[to_place(vertex)];
  const std::int32_t at = corner_at_[to_place(vertex)];
  return normal_round(at / 3, to_place(at % 3), vertices_, triangles_, across_, normals_);
}

/// Moves the vertices. Angles, from which normals of corners are computed, are most of the cost,
/// and few points are nearest to corners: after a refit these normals are computed when asked for.
void TriangleMesh::refit(std::vector<Vec3> vertices) {
  vertices_ = std::move(vertices);
  make_boxes();
  corner_normals_.clear();
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const int n = static_cast<int>(t);
    normals_[t] = normal_of(corner(n, 0), corner(n, 1), corner(n, 2));
  }
}

void TriangleMesh::join_edges() {
  std::vector<Side> sides;
  sides.reserve(3 * triangles_.size());
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), a < b,
                       static_cast<std::uint8_t>(k)});
    }
  const auto edge_of = [](const Side& s) { return std::pair(s.low, s.high); };
  std::ranges::sort(sides, {}, [](const Side& s) {
    return std::array{s.low, s.high, static_cast<int>(s.triangle)};
  });
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && edge_of(sides[end]) == edge_of(sides[begin])) ++end;
    const Side &a = sides[begin], &b = sides[end - 1];
    if (end - begin == 2 && a.upward != b.upward)
      join(a, b);
    else if (!join_round(std::span(sides).subspan(begin, end - begin)) &&
             (open_edge_ < 0 || a.triangle < open_edge_))
      open_edge_ = a.triangle;
  }
  std::ranges::sort(round_);
}

void TriangleMesh::join(const Side& a, const Side& b) {
  across_[to_place(a.triangle)][a.edge] = 3 * b.triangle + b.edge;
  across_[to_place(b.triangle)][b.edge] = 3 * a.triangle + a.edge;
}

Vec3 TriangleMesh::away_from_edge(int triangle, std::size_t k) const {
  const Vec3& from = corner(triangle, k);
  const Vec3 along = (corner(triangle, (k + 1) % 3) - from).normalized();
  const Vec3 to = corner(triangle, (k + 2) % 3) - from;
  return (to - along.dot(to) * along).normalized();
}

bool TriangleMesh::join_round(std::span<Side> sides) {
  const auto first = std::ranges::find(sides, true, &Side::upward);
  if (sides.size() < 4 || first == sides.end()) return false;
  // Behind a triangle that goes upward is its solid, which ends at the next triangle round the
  // edge.
  const Vec3 along = vertices_[to_place(first->high)] - vertices_[to_place(first->low)];
  const Vec3 ahead = away_from_edge(first->triangle, first->edge);
  const Vec3 behind = ahead.cross(along).normalized();
  std::vector<std::pair<double, Side>> round;
  for (const Side& side : sides) {
    const Vec3 away = away_from_edge(side.triangle, side.edge);
    const double angle = std::atan2(away.dot(behind), away.dot(ahead));
    round.emplace_back(side.triangle == first->triangle ? 0
                       : angle < 0                      ? angle + 2 * std::numbers::pi
                                                        : angle,
                       side);
  }
  std::ranges::sort(round, {},
                    [](const auto& one) { return std::pair(one.first, one.second.triangle); });
  constexpr double kOnEachOther = 1e-9;  // rad
  for (std::size_t k = 0; k < round.size(); ++k) {
    const double next = k + 1 < round.size() ? round[k + 1].first : 2 * std::numbers::pi;
    if (round[k].second.upward != (k % 2 == 0) || next - round[k].first < kOnEachOther)
      return false;
  }
  if (round.size() % 2 != 0) return false;
  std::vector<std::int32_t> all;
  for (const auto& [angle, side] : round) all.push_back(3 * side.triangle + side.edge);
  for (std::size_t k = 0; k < round.size(); ++k) {
    if (k % 2 == 0) join(round[k].second, round[k + 1].second);
    round_.emplace_back(all[k], all);
  }
  return true;
}

int TriangleMesh::nearest_in_angle(int edge, const Vec3& out) const {
  const auto found =
      std::ranges::lower_bound(round_, edge, {}, [](const auto& one) { return one.first; });
  if (found == round_.end() || found->first != edge) return -1;
  return *std::ranges::max_element(found->second, {}, [&](std::int32_t one) {
    return out.dot(away_from_edge(one / 3, to_place(one % 3)));
  }) / 3;
}

void TriangleMesh::build(std::int32_t begin, std::int32_t end, std::span<const Vec3> middles) {
  const std::size_t here = nodes_.size();
  nodes_.emplace_back();
  if (end - begin <= kLeaf) {
    nodes_[here].first = begin;
    nodes_[here].count = end - begin;
    return;
  }
  Eigen::AlignedBox3d box;
  for (std::int32_t k = begin; k < end; ++k) box.extend(middles[to_place(order_[to_place(k)])]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::int32_t half = begin + (end - begin) / 2;
  const auto at = [&](std::int32_t k) { return order_.begin() + k; };
  std::nth_element(at(begin), at(half), at(end), [&](std::int32_t s, std::int32_t t) {
    const double x = middles[to_place(s)][axis], y = middles[to_place(t)][axis];
    return x < y || (x == y && s < t);
  });
  build(begin, half, middles);
  nodes_[here].first = static_cast<std::int32_t>(nodes_.size());
  build(half, end, middles);
}

void TriangleMesh::make_boxes() {
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    node.box.setEmpty();
    for (std::int32_t k = 0; k < node.count; ++k)
      for (std::size_t c = 0; c < 3; ++c)
        node.box.extend(corner(order_[to_place(node.first + k)], c));
    if (node.count == 0) node.box = nodes_[n + 1].box.merged(nodes_[to_place(node.first)].box);
  }
  if (!nodes_.empty()) box_ = nodes_.front().box;
  reach_ = 0;
  for (const Vec3& x : vertices_) reach_ = std::max(reach_, x.norm());
}

void TriangleMesh::make_normals() {
  normals_.resize(triangles_.size());
  corner_normals_.assign(vertices_.size(), Vec3::Zero());
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const auto& [a, b, c] = triangles_[t];
    const std::array<Vec3, 3> x{vertices_[to_place(a)], vertices_[to_place(b)],
                                vertices_[to_place(c)]};
    normals_[t] = normal_of(x[0], x[1], x[2]);
    for (std::size_t k = 0; k < 3; ++k)
      corner_normals_[to_place(triangles_[t][k])] +=
          angle_at(x[k], x[(k + 1) % 3], x[(k + 2) % 3]) * normals_[t];
  }
}

double TriangleMesh::volume() const {
  double six = 0;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const int n = static_cast<int>(t);
    six += (corner(n, 0) - box_.center())
               .dot((corner(n, 1) - box_.center()).cross(corner(n, 2) - box_.center()));
  }
  return six / 6;
}

/// Nearest point of a triangle: Ericson, Real-Time Collision Detection, 5.1.5.
TriangleMesh::Place TriangleMesh::place_on(int triangle, const Vec3& p) const {
  const Vec3 &a = corner(triangle, 0), &b = corner(triangle, 1), &c = corner(triangle, 2);
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {a, Feature::corner, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {b, Feature::corner, 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + d1 / (d1 - d3) * ab, Feature::edge, 0};
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {c, Feature::corner, 2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + d2 / (d2 - d6) * ac, Feature::edge, 2};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return {b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), Feature::edge, 1};
  const double sum = va + vb + vc;
  return {a + vb / sum * ab + vc / sum * ac, Feature::inside, 0};
}

NearestPlace TriangleMesh::seen_from(const Vec3& p, int triangle) const {
  const Place place = place_on(triangle, p);
  const Vec3& normal = normals_[to_place(triangle)];
  const Vec3 out = p - place.point;
  const double height = normal.dot(p - corner(triangle, 0));
  // Also if p is beside the normal of a flat edge by rounding alone, which must not turn a short
  // vector.
  if (place.feature == Feature::inside || (out - height * normal).norm() <= kNoise * reach_)
    return inside_box({height, normal, triangle}, p);
  Vec3 pseudo = normal;
  if (place.feature == Feature::corner)
    pseudo = corner_normals_.empty()
                 ? normal_round(triangle, place.which, vertices_, triangles_, across_, normals_)
                 : corner_normals_[to_place(triangles_[to_place(triangle)][place.which])];
  else if (const int side = nearest_in_angle(3 * triangle + static_cast<int>(place.which), out);
           side >= 0)
    pseudo = normals_[to_place(side)];
  else if (const auto beyond = across_[to_place(triangle)][place.which]; beyond >= 0)
    pseudo += normals_[to_place(beyond / 3)];
  const double length = out.norm();
  if (pseudo.dot(out) < 0) return inside_box({-length, out / -length, triangle}, p);
  return {length, out / length, triangle};
}

template <std::size_t most>
TriangleMesh::NearestTriangles<most>::NearestTriangles() {
  triangles.fill(-1);
  squares.fill(std::numeric_limits<double>::infinity());
}

template <std::size_t most>
void TriangleMesh::NearestTriangles<most>::add(int triangle, double distance2) {
  const auto before = [&](std::size_t k) {
    return distance2 < squares[k] || (distance2 == squares[k] && triangle < triangles[k]);
  };
  if (!before(most - 1)) return;
  std::size_t k = most - 1;
  for (; k > 0 && before(k - 1); --k) {
    squares[k] = squares[k - 1];
    triangles[k] = triangles[k - 1];
  }
  squares[k] = distance2;
  triangles[k] = triangle;
}

template <std::size_t most>
TriangleMesh::NearestTriangles<most> TriangleMesh::nearest_triangles(const Vec3& p) const {
  struct Waiting {
    std::int32_t node;
    double distance2;
  };
  std::array<Waiting, kDeepest> stack;
  std::size_t waiting = 0;
  NearestTriangles<most> best;
  // Whatever its order, the walk sees every triangle that may be one of the nearest.
  const auto too_far = [&](double distance2) {
    return distance2 > best.squares[most - 1] * (1 + 1e-12);
  };
  for (Waiting at{0, 0};;) {
    const Node& node = nodes_[to_place(at.node)];
    if (!too_far(at.distance2) && node.count == 0) {
      Waiting near{at.node + 1, squared_distance(nodes_[to_place(at.node + 1)].box, p)};
      Waiting far{node.first, squared_distance(nodes_[to_place(node.first)].box, p)};
      if (far.distance2 < near.distance2) std::swap(near, far);
      if (!too_far(far.distance2)) stack[waiting++] = far;
      at = near;
      continue;
    }
    for (std::int32_t k = 0; !too_far(at.distance2) && k < node.count; ++k) {
      const int triangle = order_[to_place(node.first + k)];
      best.add(triangle, squared_distance_of(triangle, p));
    }
    if (waiting == 0) return best;
    at = stack[--waiting];
  }
}

NearestPlace TriangleMesh::nearest(const Vec3& p) const {
  return seen_from(p, std::max(0, nearest_triangles<1>(p).triangles[0]));  // 0 if p is NaN
}

/// Distance from the foot of p in the triangle's plane to its border; negative outside the
/// triangle.
double TriangleMesh::to_border(int triangle, const Vec3& p) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = corner(triangle, k), &b = corner(triangle, (k + 1) % 3);
    const Vec3 inward = normals_[to_place(triangle)].cross(b - a).normalized();
    least = std::min(least, inward.dot(p - a));
  }
  return least;
}

NearestPlace TriangleMesh::nearest(const Vec3& p, Nearby& nearby) const {
  if (!nearby.know(p)) {
    const auto found = nearest_triangles<Nearby::kMost + 1>(p);
    nearby.at = p;
    nearby.noise = 1e3 * kNoise * reach_;
    for (std::size_t k = 0; k <= Nearby::kMost; ++k)
      nearby.distances[k] = std::sqrt(found.squares[k]);
    std::copy_n(found.triangles.begin(), Nearby::kMost, nearby.triangles.begin());
    const int first = std::max(0, nearby.triangles[0]);
    // the point's distances, and that of its foot from the border, change by no more than it moves
    const double apart = (nearby.distances[1] - nearby.distances[0]) / 2;
    nearby.within = std::max(0.0, std::min(apart, to_border(first, p)) - nearby.noise);
    return seen_from(p, first);
  }
  const double moved2 = (p - nearby.at).squaredNorm();
  if (moved2 < nearby.within * nearby.within) return above(p, nearby.triangles[0]);
  const double farthest = nearby.distances[0] + 2 * std::sqrt(moved2) + nearby.noise;
  NearestTriangles<1> best;
  for (std::size_t k = 0; k < Nearby::kMost && nearby.distances[k] <= farthest; ++k)
    best.add(nearby.triangles[k], squared_distance_of(nearby.triangles[k], p));
  return seen_from(p, best.triangles[0]);
}

/// Looks along the path, as Woop, Benthin and Wald do (Watertight Ray/Triangle Intersection, 2013):
/// each corner is projected by itself, and two triangles judge the edge between them by the same
/// number with opposite signs. So no path slips through between them or at a corner.
std::optional<MeshHit> TriangleMesh::hit(int triangle, const Vec3& from, const Vec3& way) const {
  const Vec3& normal = normals_[to_place(triangle)];
  const double speed = normal.dot(way);
  if (speed == 0) return {};
  Eigen::Index z = 0;
  way.cwiseAbs().maxCoeff(&z);
  const Eigen::Index x = (z + 1) % 3, y = (z + 2) % 3;
  const double slope_x = way[x] / way[z], slope_y = way[y] / way[z];
  const auto seen = [&](std::size_t k) {
    const Vec3 p = corner(triangle, k) - from;
    return Eigen::Vector2d(p[x] - slope_x * p[z], p[y] - slope_y * p[z]);
  };
  const Eigen::Vector2d a = seen(0), b = seen(1), c = seen(2);
  const auto side = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
    return p.x() * q.y() - p.y() * q.x();
  };
  const double u = side(a, b), v = side(b, c), w = side(c, a);
  const bool within = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
  if (!within || (u == 0 && v == 0 && w == 0)) return {};
  return MeshHit{normal.dot(corner(triangle, 0) - from) / speed, triangle, speed < 0};
}

template <class Visit>
void TriangleMesh::along(const Vec3& from, const Vec3& to, const Visit& visit) const {
  std::array<std::int32_t, kDeepest> stack;
  std::size_t waiting = 0;
  const Vec3 way = to - from;
  double end = 1;
  for (std::int32_t n = 0;;) {
    const Node& node = nodes_[to_place(n)];
    const Vec3 half = end / 2 * way;
    const bool near = meets(node.box, kNoise * reach_, from + half, half);
    if (near && node.count == 0) {
      stack[waiting++] = node.first;
      ++n;
      continue;
    }
    for (std::int32_t k = 0; near && k < node.count; ++k)
      if (const auto found = hit(order_[to_place(node.first + k)], from, way))
        end = visit(*found, end);
    if (waiting == 0) return;
    n = stack[--waiting];
  }
}

std::optional<MeshHit> TriangleMesh::first_hit(const Vec3& from, const Vec3& to) const {
  std::optional<MeshHit> first;
  along(from, to, [&](const MeshHit& hit, double end) {
    if (!(hit.share >= 0 && hit.share < 1)) return end;
    if (first && std::pair(hit.share, hit.triangle) > std::pair(first->share, first->triangle))
      return end;
    first = hit;
    return hit.share;
  });
  return first;
}

std::vector<MeshHit> TriangleMesh::hits(const Vec3& from, const Vec3& to) const {
  std::vector<MeshHit> all;
  along(from, to, [&](const MeshHit& hit, double end) {
    if (hit.share >= 0 && hit.share <= 1) all.push_back(hit);
    return end;
  });
  std::ranges::sort(all, {}, [](const MeshHit& h) { return std::pair(h.share, h.triangle); });
  return all;
}

std::size_t TriangleMesh::bytes() const {
  return sizeof(*this) + vertices_.size() * (2 * sizeof(Vec3) + sizeof corner_at_[0]) +
         triangles_.size() *
             (sizeof(Triangle) + sizeof across_[0] + sizeof(Vec3) + sizeof order_[0]) +
         nodes_.size() * sizeof(Node);
}

}  // namespace taut
