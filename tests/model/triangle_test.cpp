// Triangles against points, balls, boxes and each other: exact forms compared with brute force.
#include "core/model/triangle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/model/crossings.hpp"

namespace taut::triangle_test {
namespace {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double number(double low, double high) {
    return std::uniform_real_distribution<>(low, high)(engine_);
  }
  Vec3 point(double size) {
    return {number(-size, size), number(-size, size), number(-size, size)};
  }
  Corners corners(double size) { return {point(size), point(size), point(size)}; }

 private:
  std::mt19937 engine_;
};

/// Largest value of f over a fine subdivision of the triangle.
template <class F>
double brute_force_max(const Corners& t, const F& f, int cuts = 120) {
  double best = -1e300;
  for (int i = 0; i <= cuts; ++i)
    for (int j = 0; i + j <= cuts; ++j)
      best = std::max(best, f((i * t[0] + j * t[1] + (cuts - i - j) * t[2]) / cuts));
  return best;
}

TEST(Triangle, NearestPointBeatsSubdivision) {
  Random random(1);
  for (int k = 0; k < 60; ++k) {
    const Corners t = random.corners(1);
    const Vec3 p = random.point(1.5);
    const TrianglePoint nearest = closest_point(t, p);
    EXPECT_NEAR(nearest.weights.sum(), 1, 1e-12);
    EXPECT_GE(nearest.weights.minCoeff(), 0);
    const double distance = (nearest.position - p).norm();
    const double brute = -brute_force_max(t, [&](const Vec3& q) { return -(q - p).norm(); });
    EXPECT_LE(distance, brute + 1e-12);
    EXPECT_NEAR(distance, brute, 3.5 / 120);
  }
}

TEST(Triangle, DegeneratedItStillHasANearestPoint) {
  const Vec3 a(0, 0, 0), b(2, 0, 0), m(1, 0, 0), p(0.5, 1, 0);
  EXPECT_NEAR((closest_point({a, b, m}, p).position - Vec3(0.5, 0, 0)).norm(), 0, 1e-15);
  EXPECT_NEAR((closest_point({a, a, a}, p).position - a).norm(), 0, 1e-15);
}

TEST(Triangle, DepthInABallIsThatOfSubdivision) {
  Random random(2);
  for (int k = 0; k < 60; ++k) {
    const Corners t = random.corners(1);
    const Ball ball{random.point(0.3), 0.7};
    const double brute =
        brute_force_max(t, [&](const Vec3& q) { return -surface(ball, q).distance; });
    const double exact = deepest_in(ball, t).depth;
    EXPECT_GE(exact, brute - 1e-12);
    EXPECT_NEAR(exact, brute, 3.5 / 120);
  }
}

TEST(Triangle, DepthInACapsuleIsThatOfSubdivision) {
  Random random(9);
  int pierced = 0;
  for (int k = 0; k < 100; ++k) {
    const Corners t = random.corners(1);
    Capsule capsule{random.point(0.5), random.point(0.5), 0.4};
    if (k % 5 == 0) capsule.to = capsule.from + 0.3 * (t[1] - t[0]);  // along an edge
    const double brute =
        brute_force_max(t, [&](const Vec3& q) { return -surface(capsule, q).distance; });
    const Deepest exact = deepest_in(capsule, t);
    EXPECT_GE(exact.depth, brute - 1e-12);
    EXPECT_NEAR(exact.depth, brute, 3.5 / 120);
    EXPECT_NEAR(-surface(capsule, exact.at.position).distance, exact.depth, 1e-12);
    EXPECT_NEAR(exact.at.weights.sum(), 1, 1e-12);
    EXPECT_GE(exact.at.weights.minCoeff(), 0);
    pierced += exact.depth > 0.4 - 1e-9;
  }
  EXPECT_GT(pierced, 5);
}

TEST(Triangle, DepthInABoxIsThatOfSubdivision) {
  Random random(3);
  int inside = 0;
  for (int k = 0; k < 100; ++k) {
    const Corners t = random.corners(1);
    Box box{random.point(0.3), {0.3, 0.5, 0.4}};
    box.rotation = Eigen::AngleAxisd(random.number(0, 3), random.point(1).normalized());
    const double brute =
        brute_force_max(t, [&](const Vec3& q) { return -surface(box, q).distance; });
    const Deepest exact = deepest_in(box, t);
    if (brute <= 0) continue;
    ++inside;
    EXPECT_GE(exact.depth, brute - 1e-12);
    EXPECT_NEAR(exact.depth, brute, 3.5 / 120);
    EXPECT_NEAR(-surface(box, exact.at.position).distance, exact.depth, 1e-12);
  }
  EXPECT_GT(inside, 40);
}

TEST(Triangle, ABoxCornerPokesThroughAFace) {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  // the plane x + y + z = h cuts off the corner (1, 1, 1), whose sum is 0.3 more
  const double h = 2.7;
  const Corners t{Vec3(h, 0, 0), Vec3(0, h, 0), Vec3(0, 0, h)};
  EXPECT_NEAR(deepest_in(box, t).depth, 0.1, 1e-12);  // at (0.9, 0.9, 0.9)
}

TEST(Triangle, ARejectedTriangleIsReallyNoDeeper) {
  Random random(4);
  for (int k = 0; k < 200; ++k) {
    const Corners t = random.corners(1);
    const Box box{random.point(0.3), {0.3, 0.5, 0.4}};
    const double exact = deepest_in(box, t).depth, bound = random.number(0, 0.3);
    EXPECT_NEAR(std::max(bound, deepest_in(box, t, bound).depth), std::max(bound, exact), 1e-15);
  }
}

TEST(Triangle, EnclosingRadiusOfKnownTriangles) {
  const Vec3 o(0, 0, 0), x(3, 0, 0), y(0, 4, 0);
  EXPECT_NEAR(enclosing_radius({o, x, y}), 2.5, 1e-15);                      // right
  EXPECT_NEAR(enclosing_radius({o, x, Vec3(1.5, 0.1, 0)}), 1.5, 1e-15);      // obtuse
  EXPECT_NEAR(enclosing_radius({o, x, Vec3(1.5, 1.5 * std::sqrt(3.0), 0)}),  // equilateral
              std::sqrt(3.0), 1e-12);
}

TEST(Triangle, CrossesAnotherIffAnEdgePiercesIt) {
  const Corners flat{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};
  const auto spike = [](double z) { return Corners{Vec3(1, 1, z), Vec3(1, 1, 2), Vec3(2, 1, 2)}; };
  EXPECT_TRUE(cross(flat, spike(-0.1)));
  EXPECT_TRUE(cross(spike(-0.1), flat));
  EXPECT_FALSE(cross(flat, spike(0.1)));
  EXPECT_FALSE(cross(flat, spike(0)));  // touches only
  EXPECT_FALSE(cross(flat, flat));
}

TEST(Crossings, OfATangleAreThoseOfAllPairs) {
  Random random(5);
  const Mesh mesh = make_sheet({.nu = 9, .nv = 9, .width = 1, .height = 1, .mass = 1});
  std::vector<Vec3> x = mesh.rest;
  for (Vec3& p : x) p += random.point(0.3);
  const auto& faces = mesh.triangles;
  std::vector<std::array<int, 2>> brute;
  const auto corners = [&](const Triangle& t) {
    return Corners{x[static_cast<std::size_t>(t[0])], x[static_cast<std::size_t>(t[1])],
                   x[static_cast<std::size_t>(t[2])]};
  };
  for (std::size_t s = 0; s < faces.size(); ++s)
    for (std::size_t t = s + 1; t < faces.size(); ++t) {
      const bool neighbours = std::any_of(faces[s].begin(), faces[s].end(), [&](int i) {
        return std::find(faces[t].begin(), faces[t].end(), i) != faces[t].end();
      });
      if (!neighbours && cross(corners(faces[s]), corners(faces[t])))
        brute.push_back({static_cast<int>(s), static_cast<int>(t)});
    }
  EXPECT_GT(brute.size(), 50u);
  EXPECT_EQ(crossings(faces, x), brute);
}

TEST(Crossings, AFlatSheetHasNoneHoweverItLies) {
  for (int n = 8; n <= 64; n += 7)
    for (const Vec3& v : {Vec3(0, -1, 0.15), Vec3(0.3, -1, 0.7), Vec3(-0.2, 0.1, 1)}) {
      const Mesh mesh = make_sheet({.nu = n,
                                    .nv = n,
                                    .width = 0.8,
                                    .height = 0.8,
                                    .origin = {-0.4, 0.9, 0},
                                    .u = Vec3(1, 0, 0.1).normalized(),
                                    .v = v.normalized(),
                                    .mass = 1});
      EXPECT_TRUE(crossings(mesh.triangles, mesh.rest).empty()) << n;
    }
}

TEST(Crossings, LeastGapIsThatOfAllPairs) {
  Random random(6);
  std::vector<Vec3> rest(40), x(40);
  for (Vec3& p : rest) p = random.point(0.5);
  for (Vec3& p : x) p = random.point(0.5);
  double brute = 0;
  for (std::size_t a = 0; a < x.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      brute = std::min(brute, (x[a] - x[b]).norm() - std::min(0.3, (rest[a] - rest[b]).norm()));
  EXPECT_DOUBLE_EQ(least_gap(x, rest, 0.15), brute);
}

TEST(Triangle, DistancesBeatSubdivisionAndAreZeroInTouch) {
  Random random(7);
  for (int k = 0; k < 60; ++k) {
    Corners s = random.corners(1), t = random.corners(1);
    for (Vec3& p : t) p.z() += 1.5;
    if (k % 3 == 0) t[1] = t[0] + (s[1] - s[0]);  // parallel edges
    if (cross(s, t)) continue;
    const double brute = -brute_force_max(
        s, [&](const Vec3& p) { return -(closest_point(t, p).position - p).norm(); });
    EXPECT_LE(distance(s, t), brute + 1e-12);
    EXPECT_NEAR(distance(s, t), brute, 3.5 / 120);
    EXPECT_DOUBLE_EQ(distance(s, t), distance(t, s));
  }
  const Corners flat{Vec3(0, 0, 0), Vec3(3, 0, 0), Vec3(0, 3, 0)};
  const auto beside = [&](double x) {  // a star with flat: edges cross, but no corner is inside
    return Corners{Vec3(x - 1, 1, 0), Vec3(x + 4, 1.1, 0), Vec3(x + 4, 1, 0)};
  };
  EXPECT_NEAR(distance(flat, beside(0)), 0, 1e-15);
  EXPECT_NEAR(distance(flat, beside(5)), std::sqrt(2.0), 1e-12);
}

TEST(Crossings, CoincidencesAreNearAndDoNotCross) {
  Random random(8);
  const Mesh mesh = make_sheet({.nu = 7, .nv = 7, .width = 1, .height = 1, .mass = 1});
  std::vector<Vec3> x = mesh.rest;
  for (Vec3& p : x) p += random.point(0.3);
  const auto& faces = mesh.triangles;
  const auto corners = [&](const Triangle& t) {
    return Corners{x[static_cast<std::size_t>(t[0])], x[static_cast<std::size_t>(t[1])],
                   x[static_cast<std::size_t>(t[2])]};
  };
  std::vector<std::array<int, 2>> brute;
  for (std::size_t s = 0; s < faces.size(); ++s)
    for (std::size_t t = s + 1; t < faces.size(); ++t) {
      const bool neighbours =
          std::ranges::any_of(faces[s], [&](int i) { return std::ranges::count(faces[t], i) > 0; });
      const Corners p = corners(faces[s]), q = corners(faces[t]);
      if (!neighbours && !cross(p, q) && distance(p, q) < 0.02)
        brute.push_back({static_cast<int>(s), static_cast<int>(t)});
    }
  EXPECT_GT(brute.size(), 10u);
  EXPECT_EQ(coincidences(faces, x, 0.02), brute);
}

}  // namespace
}  // namespace taut::triangle_test
