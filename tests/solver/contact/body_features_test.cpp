// Edges of a cloth against edges of a body. The first crossing is compared with a search over
// thousands of moments; cached pieces must not hide what a fresh search finds.
#include "core/solver/contact/body_features.hpp"

#include <gtest/gtest.h>

#include "tests/support/bodies.hpp"
#include "tests/support/draw.hpp"

namespace taut::body_features_test {
namespace {

/// Edge with random ends within `bound` of the origin along each axis.
Corners edge(Draw& draw, double bound) {
  const Vec3 a = draw.vector(bound), b = draw.vector(bound);
  return {a, b, b};
}

/// Shares of pq and of the fixed edge at their nearest points, taken as infinite lines (least
/// squares).
Eigen::Vector2d nearest(const Vec3& p, const Vec3& q, const FixedEdge& edge) {
  Eigen::Matrix<double, 3, 2> ways;
  ways << q - p, -edge.along;
  return ways.colPivHouseholderQr().solve(edge.from - p);
}

TEST(BodyFeatures, EdgesCrossWhereALookAtEveryMomentSeesIt) {
  Draw draw(99);
  int crossed = 0, checked = 0;
  for (int n = 0; n < 8000; ++n) {
    const bool both_move = n % 2 == 1;
    const Corners before = edge(draw, 1), now = edge(draw, 1);
    MovingEdge body{{draw.vector(1), draw.vector(1)}, {}};
    body.now = body.before;
    if (both_move) body.now = {draw.vector(1), draw.vector(1)};
    const auto edge_at = [&](double share) {
      return FixedEdge{body.end(0, share), body.end(1, share) - body.end(0, share)};
    };
    constexpr int kMoments = 4000;
    std::optional<double> first;
    double side = 0, margin = 1;
    for (int k = 0; k <= kMoments && !first; ++k) {
      const double share = k / double{kMoments};
      const Vec3 p = before[0] + share * (now[0] - before[0]),
                 q = before[1] + share * (now[1] - before[1]);
      const FixedEdge edge = edge_at(share);
      const double volume = edge.along.cross(p - edge.from).dot(q - p);
      if (k > 0 && (volume > 0) != (side > 0)) {
        const Eigen::Vector2d at = nearest(p, q, edge);
        const double inside =
            // negative if the nearest point is beyond an end of an edge
            std::min({at.x(), 1 - at.x(), at.y(), 1 - at.y()});
        margin = std::min(margin, std::abs(inside));
        if (inside > 0) first = share;
      }
      side = volume;
    }
    if (margin < 1e-2) continue;  // too close to an end for the resolution of the search
    ++checked;
    const MovingEdge cloth{{before[0], before[1]}, {now[0], now[1]}};
    const auto met =
        both_move ? first_crossing(cloth, body) : first_crossing(before, now, edge_at(0));
    ASSERT_EQ(met.has_value(), first.has_value()) << n;
    if (!met) continue;
    ++crossed;
    // the normal points back to the side from which the edge came
    const double share = std::max(0.0, *first - 2.0 / kMoments);
    const Vec3 p = before[0] + share * (now[0] - before[0]),
               q = before[1] + share * (now[1] - before[1]);
    const FixedEdge edge = edge_at(share);
    const Eigen::Vector2d at = nearest(p, q, edge);
    const Vec3 apart = p + at.x() * (q - p) - edge.from - at.y() * edge.along;
    if (apart.norm() > 1e-5) {
      EXPECT_GT(apart.dot(met->first.normal), 0) << n;
    }
    EXPECT_NEAR(met->first.normal.dot(edge_at(met->share).along), 0, 1e-12) << n;
  }
  EXPECT_GT(crossed, 200);
  EXPECT_GT(checked, 6000);
}

TEST(BodyFeatures, AFaceLeavesATipByItsDepthAndTheThickness) {
  const TriangleMesh mesh({{0, 0, 0}, {1, -1, 0}, {-0.5, -1, -0.8}, {-0.5, -1, 0.8}},
                          {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
  ASSERT_GT(mesh.volume(), 0);
  BodyFeatures features(0.01, 1);
  for (const double y : {-0.05, -0.002, 0.004}) {
    const Corners face{Vec3(1, y, 0), Vec3(-1, y, -1), Vec3(-1, y, 1)};
    const Separation out = features.out_of(mesh, 0, false, face, nullptr);
    EXPECT_NEAR(out.length, 0.01 - y, 1e-12) << y;
    EXPECT_NEAR(out.normal.y(), 1, 1e-12) << y;
  }
}

TEST(BodyFeatures, WhatPiecesRememberHidesNothing) {
  const auto mesh = torus(0.3, 0.12, 16, 10, 0.02).mesh();
  constexpr double kThickness = 0.005;
  for (const bool edge : {true, false}) {
    Draw draw(99);
    int pushed = 0, same = 0;
    BodyFeatures remembering(kThickness, 1);
    Vec3 at(0.3, 0.15, 0);
    Corners before{at, at + Vec3(0.05, 0, 0.02), at + Vec3(0.01, 0.02, 0.05)};
    if (edge) before[2] = before[1];
    for (int n = 0; n < 20000; ++n) {
      Corners now = before;
      const double step = n % 100 == 0 ? 0.1 : 0.003;
      const Vec3 all = draw.vector(step);
      for (Vec3& x : now) x += all + draw.vector(step / 10);
      if (now[0].norm() > 0.5)
        for (Vec3& x : now) x *= 0.9;
      if (edge) now[2] = now[1];
      BodyFeatures anew(kThickness, 1);
      const BodyFeatures::Before start{before};
      const BodyFeatures::Before* const path = edge && n % 2 == 0 ? &start : nullptr;
      const Separation got = remembering.out_of(*mesh, 0, edge, now, path),
                       want = anew.out_of(*mesh, 0, edge, now, path);
      const bool far_inside = want.length > 2 * kThickness && !want.has_passed;
      if (!far_inside) {
        ASSERT_GE(got.length, want.length) << n;
      }
      same += got.length == want.length && got.normal == want.normal;
      pushed += got.length > 0;
      before = now;
    }
    EXPECT_GT(pushed, 50) << edge;
    EXPECT_GT(same, 15000) << edge << ": from far inside a fresh look may see other ones";
  }
}

}  // namespace
}  // namespace taut::body_features_test
