// A body of triangles agrees with closed forms where they exist, and with a search of all its
// triangles everywhere.
#include "core/model/triangle_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <random>

#include "core/model/collider.hpp"
#include "core/model/triangle.hpp"
#include "tests/support/bodies.hpp"

namespace taut::triangle_mesh_test {
namespace {

class Random {
 public:
  double within(double bound) { return std::uniform_real_distribution<>(-bound, bound)(engine_); }
  Vec3 point(double bound) { return {within(bound), within(bound), within(bound)}; }

 private:
  std::mt19937_64 engine_{4711};
};

const Vec3 kHalf(0.3, 0.2, 0.45);

/// Point at which a path from outside first meets the box, by its three slabs.
std::optional<std::pair<double, Vec3>> slab_hit(const Vec3& a, const Vec3& b) {
  double in = -1, out = 1;
  Vec3 normal = Vec3::Zero();
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double way = b[k] - a[k], side = way > 0 ? -1 : 1;
    const double enters = (side * kHalf[k] - a[k]) / way, leaves = (-side * kHalf[k] - a[k]) / way;
    if (enters > in) {
      in = enters;
      normal = side * Vec3::Unit(k);
    }
    out = std::min(out, leaves);
  }
  if (in < 0 || in >= out) return {};
  return std::pair(in, normal);
}

// Regression: at the tip of a scanned tail that crosses itself triangles look inward.
TEST(TriangleMesh, NothingOutsideItsBoxIsInside) {
  Triangles body = box_of_triangles(kHalf);
  const Triangles tip = box_of_triangles(Vec3(0.01, 0.01, 0.01));
  for (const auto& [a, b, c] : tip.triangles) body.triangles.push_back({a + 8, c + 8, b + 8});
  for (const Vec3& x : tip.vertices) body.vertices.emplace_back(x + Vec3(0.5, 0, 0));
  const auto mesh = body.mesh();
  ASSERT_TRUE(mesh->closed());
  const Vec3 point(0.7, 0.005, 0.002);
  TriangleMesh::Nearby nearby;
  for (const NearestPlace& place :
       {mesh->nearest(point), mesh->nearest(point, nearby), mesh->nearest(point, nearby),
        mesh->nearest(Vec3(0.7, 0.05, 0.05))}) {
    EXPECT_GT(place.distance, 0.18);
    EXPECT_GT(place.normal.x(), 0.9);
  }
  EXPECT_LT(mesh->nearest(Vec3(0.2, 0, 0)).distance, 0);
}

TEST(TriangleMesh, ABoxOfTrianglesIsTheBoxOnAMillionSegments) {
  const Vec3 center(0.2, -0.4, 0.1);
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized()));
  const Shape box = Box{center, kHalf, turned};
  const Shape body = MeshBody{box_of_triangles(kHalf).mesh(), center, turned};
  Random random;
  int hits = 0, inside = 0, far_apart = 0, ties = 0;
  for (int n = 0; n < 1000000; ++n) {
    const Vec3 p = center + random.point(0.8), q = center + random.point(0.8);
    const Surface want = surface(box, p), got = surface(body, p);
    far_apart += std::abs(want.distance - got.distance) > 1e-12;
    inside += want.distance < 0;
    // Near the medial axis two sides are equally near; at the surface the direction is undefined.
    const Vec3 local = turned.conjugate() * (p - center);
    Vec3 gaps = kHalf - local.cwiseAbs();
    std::sort(gaps.begin(), gaps.end());
    const bool tie = want.distance < 0 && gaps[1] - gaps[0] < 1e-9;
    ties += tie;
    if (!tie && std::abs(want.distance) > 1e-3)
      far_apart += !((want.normal - got.normal).norm() <= 1e-12);
    if (want.distance < 0) continue;
    const Vec3 to = turned.conjugate() * (q - center);
    const auto by_slabs = slab_hit(local, to);
    const auto by_tree = std::get<MeshBody>(body).mesh->first_hit(local, to);
    ASSERT_EQ(by_slabs.has_value(), by_tree.has_value()) << n;
    if (!by_slabs) continue;
    ++hits;
    far_apart += std::abs(by_slabs->first - by_tree->share) > 1e-12 || !by_tree->inward;
    far_apart += std::get<MeshBody>(body).mesh->normal(by_tree->triangle) != by_slabs->second;
  }
  EXPECT_EQ(far_apart, 0);
  EXPECT_GT(hits, 50000);
  EXPECT_GT(inside, 20000);
  EXPECT_LT(ties, 10);
}

TEST(TriangleMesh, ATessellatedBallIsTheBallToSecondOrder) {
  constexpr double kRadius = 0.4;
  Random random;
  double before = 0;
  for (const int times : {2, 3, 4, 5}) {
    const Triangles ball = ball_of_triangles(kRadius, times);
    const auto mesh = ball.mesh();
    EXPECT_TRUE(mesh->closed());
    double longest = 0, worst = 0;
    for (const auto& [a, b, c] : ball.triangles)
      for (const auto& [v, w] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
        longest = std::max(longest,
                           (mesh->vertices()[to_index(v)] - mesh->vertices()[to_index(w)]).norm());
    for (int n = 0; n < 20000; ++n) {
      const Vec3 p = random.point(1).normalized() * (kRadius + random.within(0.1));
      worst = std::max(worst, std::abs(mesh->nearest(p).distance - (p.norm() - kRadius)));
    }
    // Height of the cap over the middle of a triangle of sides e: e^2/(6R) and higher orders.
    EXPECT_LE(worst, kRadius - std::sqrt(kRadius * kRadius - longest * longest / 3)) << times;
    if (before > 0) {
      EXPECT_NEAR(before / worst, 4, 0.5) << times;
    }
    before = worst;
  }
}

/// Winding number of the mesh around p, from solid angles: 1 inside, 0 outside (Van Oosterom,
/// Strackee 1983).
double winding(const TriangleMesh& mesh, const Vec3& p) {
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles()) {
    const Vec3 a = mesh.vertices()[to_index(i)] - p, b = mesh.vertices()[to_index(j)] - p,
               c = mesh.vertices()[to_index(k)] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

Corners corners(const TriangleMesh& mesh, const Triangle& t) {
  return {mesh.vertices()[to_index(t[0])], mesh.vertices()[to_index(t[1])],
          mesh.vertices()[to_index(t[2])]};
}

/// Share of the path at which it meets a triangle, from the system of barycentric coordinates.
std::optional<double> share_at(const Corners& t, const Vec3& from, const Vec3& to) {
  Eigen::Matrix3d m;
  m << from - to, t[1] - t[0], t[2] - t[0];
  const Vec3 s = m.partialPivLu().solve(from - t[0]);
  if (s[0] < 0 || s[0] > 1 || s[1] < 0 || s[2] < 0 || s[1] + s[2] > 1) return {};
  return s[0];
}

struct Named {
  const char* name;
  Triangles body;
};
std::vector<Named> bodies() {
  return {{"pyramid", pyramid(0.8, 0.6)},
          {"torus", torus(0.5, 0.15, 24, 12)},
          {"irregular", torus(0.5, 0.18, 31, 17, 0.05)}};
}

void expect_all_seen(const char* name, const TriangleMesh& mesh) {
  ASSERT_TRUE(mesh.closed()) << name;
  EXPECT_GT(mesh.volume(), 0) << name;
  Random random;
  int inside = 0, hits = 0;
  for (int n = 0; n < 3000; ++n) {
    const Vec3 p = random.point(0.8), q = random.point(0.8);
    double least = std::numeric_limits<double>::infinity();
    std::vector<double> shares;
    std::size_t boxes = 0, in_box = 0;
    const Eigen::AlignedBox3d around(p.cwiseMin(q), p.cwiseMax(q));
    for (const Triangle& t : mesh.triangles()) {
      const Corners c = corners(mesh, t);
      least = std::min(least, (closest_point(c, p).position - p).norm());
      if (const auto share = share_at(c, p, q)) shares.push_back(*share);
      Eigen::AlignedBox3d own(c[0]);
      boxes += own.extend(c[1]).extend(c[2]).intersects(around);
    }
    const bool is_inside = winding(mesh, p) > 0.5;
    inside += is_inside;
    const NearestPlace place = mesh.nearest(p);
    EXPECT_NEAR(place.distance, is_inside ? -least : least, 1e-12) << name << ' ' << n;
    EXPECT_NEAR(place.normal.norm(), 1, 1e-12) << name << ' ' << n;
    // Gradient: a step along it changes the distance by the length of the step.
    const double step = 1e-4 * std::abs(place.distance);
    EXPECT_NEAR(
        std::abs(mesh.nearest(p - std::copysign(step, place.distance) * place.normal).distance),
        std::abs(place.distance) - step, 1e-12)
        << name << ' ' << n;
    std::ranges::sort(shares);
    std::vector<double> seen;
    for (const MeshHit& hit : mesh.hits(p, q)) seen.push_back(hit.share);
    ASSERT_EQ(seen.size(), shares.size()) << name << ' ' << n;
    for (std::size_t k = 0; k < seen.size(); ++k) EXPECT_NEAR(seen[k], shares[k], 1e-10);
    const auto first = mesh.first_hit(p, q);
    ASSERT_EQ(first.has_value(), !shares.empty()) << name << ' ' << n;
    if (first) {
      ++hits;
      EXPECT_EQ(first->share, seen.front()) << name << ' ' << n;
      EXPECT_EQ(first->inward, !is_inside) << name << ' ' << n;
    }
    mesh.in_box(around, [&](int) { ++in_box; });
    EXPECT_EQ(in_box, boxes) << name << ' ' << n;
  }
  EXPECT_GT(inside, 50) << name;
  EXPECT_GT(hits, 100) << name;
}

TEST(TriangleMesh, TheTreeSeesWhatALookAtAllTrianglesSees) {
  for (const auto& [name, body] : bodies()) expect_all_seen(name, *body.mesh());
}

// A point that was looked up before and moves a little gets the same bits as a full search.
TEST(TriangleMesh, WhatIsNearbyAnswersToTheBit) {
  for (const auto& [name, body] : bodies()) {
    const auto mesh = body.mesh();
    Random random;
    int known = 0, within = 0, asked = 0;
    for (int n = 0; n < 600; ++n) {
      TriangleMesh::Nearby nearby;
      Vec3 p = random.point(0.8);
      // edges and corners are nearest as well; steps are small and large
      if (n % 3 == 0) p = 1.02 * body.vertices[to_index(n) % body.vertices.size()];
      for (int k = 0; k < 30; ++k) {
        const NearestPlace want = mesh->nearest(p);
        known += nearby.know(p);
        within += (p - nearby.at).norm() < nearby.within;
        ++asked;
        const NearestPlace got = mesh->nearest(p, nearby);
        ASSERT_EQ(got.distance, want.distance) << name << ' ' << n;
        ASSERT_EQ(got.normal, want.normal) << name << ' ' << n;
        ASSERT_EQ(got.triangle, want.triangle) << name << ' ' << n;
        p += (k % 7 == 0 ? 0.05 : 0.004) * random.point(1);
      }
    }
    EXPECT_GT(known, asked / 5) << name;
    EXPECT_GT(within, asked / 100) << name;
  }
}

TEST(TriangleMesh, WhatIsNearbyEndsAtAnOpenBorder) {
  const TriangleMesh mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  TriangleMesh::Nearby nearby;
  mesh.nearest({0.1, 0.2, 0.5}, nearby);
  for (const Vec3& p : {Vec3(0.05, 0.2, 0.5), Vec3(-0.3, 0.2, 0.5), Vec3(0.1, -1, 0.5)})
    EXPECT_EQ(mesh.nearest(p, nearby).distance, mesh.nearest(p).distance) << p.transpose();
}

TEST(TriangleMesh, RefittedItAnswersAsOneMadeAnew) {
  for (const auto& [name, body] : bodies()) {
    std::vector<Vec3> moved = body.vertices;
    for (Vec3& x : moved) x = Vec3(1.2 * x.z(), 0.9 * x.x(), 0.8 * x.y() + 0.1 * x.x());
    TriangleMesh mesh(body.vertices, body.triangles);
    mesh.refit(moved);
    expect_all_seen(name, mesh);
    const TriangleMesh anew(moved, body.triangles);
    Random random;
    for (int n = 0; n < 1000; ++n) {
      const Vec3 p = random.point(1);
      EXPECT_EQ(mesh.nearest(p).distance, anew.nearest(p).distance) << name;
      EXPECT_EQ(mesh.nearest(p).normal, anew.nearest(p).normal) << name;
    }
  }
}

// No path slips between triangles: every path out of the middle of a ball has one hit, also through
// edges and corners.
TEST(TriangleMesh, NoPathSlipsBetweenTriangles) {
  const Triangles ball = ball_of_triangles(1, 3);
  const auto mesh = ball.mesh();
  const Vec3 from(0.03, -0.02, 0.01);
  for (const auto& [a, b, c] : ball.triangles) {
    const Corners t = corners(*mesh, {a, b, c});
    for (const double s : {0.0, 0.1, 1.0 / 3, 0.5, 0.9})
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 on = (1 - s) * t[k] + s * t[(k + 1) % 3];
        const auto hit = mesh->first_hit(from, from + 1.5 * (on - from));
        ASSERT_TRUE(hit);
        EXPECT_NEAR(hit->share, 1 / 1.5, 1e-3);
        EXPECT_FALSE(hit->inward);
      }
  }
}

TEST(TriangleMesh, SaysWhereItIsOpen) {
  Triangles box = box_of_triangles(kHalf);
  EXPECT_TRUE(box.mesh()->closed());
  EXPECT_NEAR(box.mesh()->volume(), 8 * kHalf.prod(), 1e-15);
  std::swap(box.triangles[5][0], box.triangles[5][1]);  // looks inward
  EXPECT_FALSE(box.mesh()->closed());
  box = box_of_triangles(kHalf);
  box.triangles.pop_back();
  EXPECT_FALSE(box.mesh()->closed());
  box = box_of_triangles(kHalf);
  box.triangles.push_back({0, 7, 3});  // an inner wall: edges with three triangles
  EXPECT_FALSE(box.mesh()->closed());
}

/// Prism along z, from -1 to 1, over an outline that all of can be seen from its first corner.
Triangles prism(const std::vector<std::array<double, 2>>& outline) {
  Triangles made;
  for (const double z : {-1.0, 1.0})
    for (const auto& [x, y] : outline) made.vertices.emplace_back(x, y, z);
  const int n = static_cast<int>(outline.size());
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    made.triangles.push_back({k, next, next + n});
    made.triangles.push_back({k, next + n, k + n});
    if (k == 0 || next == 0) continue;
    made.triangles.push_back({0, next, k});
    made.triangles.push_back({n, k + n, next + n});
  }
  return made;
}

// The notch of an L and a wedge in it have an edge in common, with four faces. Inside the L that
// edge is the nearest place of many points, and the faces of the wedge look at them from outside.
TEST(TriangleMesh, SolidsMayTouchInAnEdge) {
  const Triangles notched = prism({{0, 0}, {0, 2}, {-2, 2}, {-2, -2}, {2, -2}, {2, 0}});
  const Triangles wedge = prism({{0, 0}, {2, 1}, {1, 2}});
  for (const bool wedge_first : {false, true}) {
    Triangles both = wedge_first ? wedge : notched;
    const Triangles& other = wedge_first ? notched : wedge;
    const int own = static_cast<int>(both.vertices.size());
    const int before = static_cast<int>(other.vertices.size()) / 2;
    const auto joined = [&](int v) { return v == 0 ? 0 : v == before ? own / 2 : own + v; };
    for (const auto& [a, b, c] : other.triangles)
      both.triangles.push_back({joined(a), joined(b), joined(c)});
    both.vertices.insert(both.vertices.end(), other.vertices.begin(), other.vertices.end());
    const auto mesh = both.mesh();
    ASSERT_TRUE(mesh->closed());
    EXPECT_NEAR(mesh->volume(), notched.mesh()->volume() + wedge.mesh()->volume(), 1e-14);
    EXPECT_LT(mesh->nearest({-0.1, -0.1, 0}).distance, -0.14);
    Random random;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 p = i % 2 == 0 ? random.point(2.5) : random.point(0.3);
      const double one = notched.mesh()->nearest(p).distance,
                   two = wedge.mesh()->nearest(p).distance;
      ASSERT_NEAR(mesh->nearest(p).distance, std::min(one, two), 1e-12) << p.transpose();
    }
    for (std::size_t t = 0; t < mesh->triangles().size(); ++t)  // those of one solid are joined
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(mesh->beyond(static_cast<int>(t), k) / 3 <
                      static_cast<int>((wedge_first ? wedge : notched).triangles.size()),
                  t < (wedge_first ? wedge : notched).triangles.size());
    std::swap(both.triangles[0][0], both.triangles[0][1]);
    EXPECT_FALSE(both.mesh()->closed());
  }
}

TEST(TriangleMesh, AThinBodyIsAtADistanceOnBothSides) {
  Triangles half = box_of_triangles(kHalf);
  half.triangles = {half.triangles[6], half.triangles[7]};  // its top alone
  const Shape thin = MeshBody{.mesh = half.mesh(), .sides = MeshBody::Sides::both};
  for (const double y : {-0.1, 0.1}) {
    const Surface over = surface(thin, {0.05, kHalf.y() + y, 0.1});
    EXPECT_NEAR(over.distance, 0.1, 1e-15);
    EXPECT_NEAR((over.normal - std::copysign(1, y) * Vec3::UnitY()).norm(), 0, 1e-15);
    const Surface beside = surface(thin, {kHalf.x() + 0.1, kHalf.y() + y, 0.1});
    EXPECT_NEAR(beside.distance, std::sqrt(0.02), 1e-15);
    EXPECT_NEAR((beside.normal - Vec3(1, std::copysign(1, y), 0) / std::sqrt(2)).norm(), 0, 1e-12);
  }
}

}  // namespace
}  // namespace taut::triangle_mesh_test
