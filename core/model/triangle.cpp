#include "core/model/triangle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/model/triangle_mesh.hpp"

namespace taut {

namespace {

Vec3 at(const Corners& t, const Vec3& weights) {
  return weights[0] * t[0] + weights[1] * t[1] + weights[2] * t[2];
}

/// Share of b in the point of segment ab that is nearest to p.
double nearest_share(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 along = b - a;
  const double length2 = along.squaredNorm();
  return length2 > 0 ? std::clamp(along.dot(p - a) / length2, 0.0, 1.0) : 0.0;
}

/// Where the segments pq and ab are nearest to each other, as shares of q and b.
std::pair<double, double> nearest_shares(const Vec3& p, const Vec3& q, const Vec3& a,
                                         const Vec3& b) {
  const Vec3 u = q - p, v = b - a, r = a - p;
  const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm();
  const double det = uu * vv - uv * uv;
  // Take the nearest point of the lines, clamp it to pq, then to ab, and project back.
  double on_pq = det > 0 ? std::clamp((vv * u.dot(r) - uv * v.dot(r)) / det, 0.0, 1.0) : 0;
  const double on_ab = nearest_share(a, b, p + on_pq * u);
  on_pq = nearest_share(p, q, a + on_ab * v);
  return {on_pq, on_ab};
}

/// Distance between the segments pq and ab [m].
double distance(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  const auto [on_pq, on_ab] = nearest_shares(p, q, a, b);
  return (p + on_pq * (q - p) - a - on_ab * (b - a)).norm();
}

/// Six times the volume of the tetrahedron; positive if d is above the triangle abc. 0 if the sign
/// may be due to rounding of the coordinates: faces in one plane do not cross.
double orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 ab = b - a, ac = c - a, ad = d - a;
  const double volume = ab.cross(ac).dot(ad);
  const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), ad.squaredNorm()});
  const double noise = 1e-14 * longest2 * (a.cwiseAbs().maxCoeff() + std::sqrt(longest2));
  return std::abs(volume) <= noise ? 0 : volume;
}

/// True if the segment pq passes through the inside of the triangle.
bool pierces(const Vec3& p, const Vec3& q, const Corners& t) {
  const double below = orientation(t[0], t[1], t[2], p), above = orientation(t[0], t[1], t[2], q);
  if (!(below * above < 0)) return false;
  const double u = orientation(p, q, t[0], t[1]), v = orientation(p, q, t[1], t[2]),
               w = orientation(p, q, t[2], t[0]);
  return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

/// The point where the line pq passes through the plane of t. Precondition: it does.
Vec3 passage(const Vec3& p, const Vec3& q, const Corners& t) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double below = normal.dot(p - t[0]), above = normal.dot(q - t[0]);
  return p + below / (below - above) * (q - p);
}

/// True if the plane of t has corners of s strictly on both sides.
bool straddles(const Corners& s, const Corners& t) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const Vec3 heights(normal.dot(s[0] - t[0]), normal.dot(s[1] - t[0]), normal.dot(s[2] - t[0]));
  return heights.minCoeff() < 0 && heights.maxCoeff() > 0;
}

/// Depths below the six faces of a box, each linear over the triangle: [face][corner].
using Depths = std::array<Vec3, 6>;

double depth_at(const Depths& depths, const Vec3& weights) {
  double least = depths[0].dot(weights);
  for (std::size_t f = 1; f < depths.size(); ++f) least = std::min(least, depths[f].dot(weights));
  return least;
}

/// Calls visit(weights) for every point that can be the maximum of the least depth.
template <class Visit>
void candidates(const Depths& d, const Visit& visit) {
  for (int corner = 0; corner < 3; ++corner) visit(Vec3::Unit(corner));
  for (std::size_t f = 0; f < d.size(); ++f)
    for (std::size_t g = f + 1; g < d.size(); ++g) {
      const Vec3 fg = d[f] - d[g];
      for (int a = 0; a < 3; ++a) {  // on the edge from corner a to the next
        const int b = (a + 1) % 3;
        if (!(fg[a] * fg[b] < 0)) continue;
        Vec3 weights = Vec3::Zero();
        weights[b] = fg[a] / (fg[a] - fg[b]);
        weights[a] = 1 - weights[b];
        visit(weights);
      }
      for (std::size_t h = g + 1; h < d.size(); ++h) {  // inside: fg . w = fh . w = 0
        const Vec3 w = fg.cross(d[f] - d[h]);
        const double sum = w.sum();
        if (sum == 0) continue;
        const Vec3 weights = w / sum;
        if (weights.minCoeff() >= 0) visit(weights);
      }
    }
}

}  // namespace

TrianglePoint closest_point(const Corners& t, const Vec3& p) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double twice_area2 = normal.squaredNorm();
  if (twice_area2 > 0) {
    const Vec3 weights =
        Vec3(normal.dot((t[2] - t[1]).cross(p - t[1])), normal.dot((t[0] - t[2]).cross(p - t[2])),
             normal.dot((t[1] - t[0]).cross(p - t[0]))) /
        twice_area2;
    if (weights.minCoeff() >= 0) return {at(t, weights), weights};
  }
  TrianglePoint best;
  double least = -1;
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    const auto ia = static_cast<std::size_t>(a), ib = static_cast<std::size_t>(b);
    Vec3 weights = Vec3::Zero();
    weights[b] = nearest_share(t[ia], t[ib], p);
    weights[a] = 1 - weights[b];
    const Vec3 point = at(t, weights);
    const double distance2 = (point - p).squaredNorm();
    if (least >= 0 && distance2 >= least) continue;
    least = distance2;
    best = {point, weights};
  }
  return best;
}

Deepest deepest_in(const Ball& ball, const Corners& t) {
  const TrianglePoint nearest = closest_point(t, ball.center);
  return {ball.radius - (nearest.position - ball.center).norm(), nearest};
}

Deepest deepest_in(const Capsule& capsule, const Corners& t) {
  const Vec3 &from = capsule.from, &to = capsule.to;
  Deepest best{-std::numeric_limits<double>::infinity(), {t[0], Vec3::UnitX()}};
  const auto improve = [&](const TrianglePoint& point) {
    const double depth = -surface(capsule, point.position).distance;
    if (depth > best.depth) best = {depth, point};
  };
  if (pierces(from, to, t)) {
    improve(closest_point(t, passage(from, to, t)));
    return best;
  }
  improve(closest_point(t, from));
  improve(closest_point(t, to));
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    Vec3 weights = Vec3::Zero();
    weights[b] =
        nearest_shares(t[static_cast<std::size_t>(a)], t[static_cast<std::size_t>(b)], from, to)
            .first;
    weights[a] = 1 - weights[b];
    improve({at(t, weights), weights});
  }
  return best;
}

Deepest deepest_in(const Box& box, const Corners& t, double at_least) {
  Depths depths;
  double bound = at_least;
  Deepest best{-box.half_extents.norm(), {t[0], Vec3::UnitX()}};
  std::array<Vec3, 3> local;
  for (std::size_t c = 0; c < 3; ++c) local[c] = box.rotation.conjugate() * (t[c] - box.center);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<Eigen::Index>(axis);
    const Vec3 along(local[0][k], local[1][k], local[2][k]);
    const Vec3 half = Vec3::Constant(box.half_extents[k]);
    depths[2 * axis] = half - along;
    depths[2 * axis + 1] = half + along;
  }
  double ceiling = depths[0].maxCoeff();
  for (const Vec3& d : depths) ceiling = std::min(ceiling, d.maxCoeff());
  if (ceiling <= bound) return {bound, best.at};
  const auto improve = [&](const Vec3& weights) {
    const double depth = depth_at(depths, weights);
    if (depth > best.depth) best = {depth, {Vec3::Zero(), weights}};
  };
  for (int corner = 0; corner < 3; ++corner) improve(Vec3::Unit(corner));
  if (best.depth < ceiling) candidates(depths, improve);
  best.at.position = at(t, best.at.weights);
  return best;
}

double deepest_in(const TriangleMesh& body, const Corners& triangle, double at_least) {
  double longest = 0;
  Eigen::AlignedBox3d around;
  for (std::size_t c = 0; c < 3; ++c) {
    longest = std::max(longest, (triangle[(c + 1) % 3] - triangle[c]).norm());
    around.extend(triangle[c]);
  }
  if (around.exteriorDistance(body.box()) > std::max(0.0, -at_least)) return at_least;
  double deepest = at_least;
  std::vector<Corners> parts{triangle};
  while (!parts.empty()) {
    const Corners t = parts.back();
    parts.pop_back();
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3;
    double reach = 0;
    for (const Vec3& corner : t) reach = std::max(reach, (corner - middle).norm());
    const double depth = -body.nearest(middle).distance;
    deepest = std::max(deepest, depth);
    if (depth + reach <= deepest + kDepthError * longest) continue;
    const Vec3 ab = (t[0] + t[1]) / 2, bc = (t[1] + t[2]) / 2, ca = (t[2] + t[0]) / 2;
    parts.insert(parts.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
  }
  return deepest;
}

double enclosing_radius(const Corners& t) {
  std::array<double, 3> edge2{(t[1] - t[0]).squaredNorm(), (t[2] - t[1]).squaredNorm(),
                              (t[0] - t[2]).squaredNorm()};
  std::sort(edge2.begin(), edge2.end());
  const double twice_area = (t[1] - t[0]).cross(t[2] - t[0]).norm();
  if (edge2[2] >= edge2[0] + edge2[1] || twice_area == 0) return std::sqrt(edge2[2]) / 2;
  return std::sqrt(edge2[0] * edge2[1] * edge2[2]) / (2 * twice_area);
}

bool cross(const Corners& s, const Corners& t) {
  if (!straddles(s, t) && !straddles(t, s)) return false;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3;
    if (pierces(s[a], s[b], t) || pierces(t[a], t[b], s)) return true;
  }
  return false;
}

double crossing_length(const Corners& s, const Corners& t) {
  std::array<Vec3, 6> ends;
  std::size_t count = 0;
  const auto add = [&](const Vec3& p, const Vec3& q, const Corners& through) {
    if (!pierces(p, q, through)) return;
    ends[count++] = passage(p, q, through);
  };
  for (std::size_t a = 0; a < 3; ++a) {
    add(s[a], s[(a + 1) % 3], t);
    add(t[a], t[(a + 1) % 3], s);
  }
  double longest = 0;
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = 0; b < a; ++b) longest = std::max(longest, (ends[a] - ends[b]).norm());
  return longest;
}

double distance(const Corners& s, const Corners& t) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; ++a) {
    least = std::min(least, (closest_point(t, s[a]).position - s[a]).norm());
    least = std::min(least, (closest_point(s, t[a]).position - t[a]).norm());
    for (std::size_t b = 0; b < 3; ++b)
      least = std::min(least, distance(s[a], s[(a + 1) % 3], t[b], t[(b + 1) % 3]));
  }
  return least;
}

}  // namespace taut
