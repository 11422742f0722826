// Deforming body between two moments: positions between frames, the first triangle on the path of a
// moving point, and the motion of things that lie on the surface.
#include "core/model/deforming_body.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/model/body_frames.hpp"
#include "tests/support/bodies.hpp"

namespace taut::deforming_body_test {
namespace {

class Random {
 public:
  double number() {  // in [-1, 1]
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1;
  }
  Vec3 point(double reach) {
    const double x = number(), y = number(), z = number();
    return reach * Vec3(x, y, z);
  }
  Corners triangle(double reach) { return {point(reach), point(reach), point(reach)}; }

 private:
  std::uint64_t state_ = 1;
};

/// Positions of a body that swells, leans and turns from frame to frame.
std::vector<Vec3> bent(const std::vector<Vec3>& x, double s) {
  const Eigen::AngleAxisd turn(0.3 * s, Vec3(1, 2, 1).normalized());
  std::vector<Vec3> y;
  for (const Vec3& p : x) {
    const Vec3 leaning = p + s * Vec3(0.2 * p.y() * p.y(), 0.1 * p.x(), 0.3 * p.x() * p.z());
    y.push_back(turn * leaning + s * Vec3(0.05, 0, 0.02));
  }
  return y;
}

Collider bending(const Triangles& body, int frames, double fps) {
  auto over_time = std::make_shared<BodyFrames>();
  over_time->fps = fps;
  for (int k = 0; k < frames; ++k) over_time->places.push_back(bent(body.vertices, k));
  return {.shape = MeshBody{body.mesh(), {0.1, 0.2, 0.3}},
          .motion = {.velocity = {1, 0, 0.5}, .spin = {0.2, 1, 0}, .pivot = {0.1, 0, 0}},
          .frames = over_time};
}

TEST(BodyFrames, AreLinearBetweenAndRestAtTheEnd) {
  const BodyFrames frames{.places = {{{0, 0, 0}}, {{1, 2, 3}}, {{1, 4, 3}}}, .fps = 4};
  EXPECT_EQ(frames.at(0)[0], Vec3(0, 0, 0));
  EXPECT_EQ(frames.at(0.125)[0], Vec3(0.5, 1, 1.5));
  EXPECT_EQ(frames.at(0.25)[0], Vec3(1, 2, 3));
  EXPECT_EQ(frames.at(0.4375)[0], Vec3(1, 3.5, 3));
  for (const double t : {0.5, 0.75, 1e6}) EXPECT_EQ(frames.at(t)[0], Vec3(1, 4, 3));
}

/// Height of a point over a triangle times twice the triangle's area, and whether the point is
/// above it.
std::pair<double, bool> height(const Corners& t, const Vec3& p) {
  const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
  bool above = true;
  for (std::size_t k = 0; k < 3; ++k)
    above = above && (t[(k + 1) % 3] - t[k]).cross(p - t[k]).dot(n) >= 0;
  return {n.dot(p - t[0]), above};
}

/// Shares of the motion after which the point is on the other side of the plane, within the
/// triangle, found by sampling `moments` moments.
std::vector<double> seen_passes(const Corners& before, const Corners& after, const Vec3& from,
                                const Vec3& to, int moments) {
  std::vector<double> all;
  double last = 0;
  for (int n = 0; n <= moments; ++n) {
    const double s = n / double(moments);
    Corners now;
    for (std::size_t k = 0; k < 3; ++k) now[k] = before[k] + s * (after[k] - before[k]);
    const auto [high, above] = height(now, from + s * (to - from));
    if (n > 0 && (high > 0) != (last > 0) && above) all.push_back(s);
    last = high;
  }
  return all;
}

TEST(TrianglePasses, AreThoseThatAreSeenAtManyMoments) {
  Random random;
  int with[4] = {}, differ = 0;
  constexpr int kMoments = 2000, kTriangles = 3000;
  for (int n = 0; n < kTriangles; ++n) {
    const Corners before = random.triangle(1), after = random.triangle(1);
    const Vec3 from = random.point(0.5), to = random.point(0.5);
    const auto all = passes(before, after, from, to);
    const auto seen = seen_passes(before, after, from, to, kMoments);
    ASSERT_LE(all.size(), 3u);
    ++with[all.size()];
    if (all.size() != seen.size()) {  // at an edge, or two passes within one moment
      ++differ;
      continue;
    }
    for (std::size_t k = 0; k < all.size(); ++k)
      EXPECT_NEAR(all[k].share, seen[k], 1.001 / kMoments);
  }
  EXPECT_LE(differ, kTriangles / 100);
  EXPECT_GT(with[1], kTriangles / 10);
  EXPECT_GT(with[2], kTriangles / 100);
}

TEST(TrianglePasses, OfATriangleAtRestAreItsHits) {
  const Triangles ball = ball_of_triangles(0.5, 2);
  const auto mesh = ball.mesh();
  Random random;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 from = random.point(0.8), to = random.point(0.8);
    std::vector<MeshHit> found;
    for (std::size_t t = 0; t < ball.triangles.size(); ++t) {
      Corners at;
      for (std::size_t k = 0; k < 3; ++k) at[k] = ball.vertices[to_index(ball.triangles[t][k])];
      for (const auto& [share, inward] : passes(at, at, from, to))
        found.push_back({share, static_cast<int>(t), inward});
    }
    const auto hits = mesh->hits(from, to);
    ASSERT_EQ(found.size(), hits.size());
    for (const MeshHit& hit : hits) {
      const auto same = std::ranges::find(found, hit.triangle, &MeshHit::triangle);
      ASSERT_NE(same, found.end());
      EXPECT_NEAR(same->share, hit.share, 1e-12);
      EXPECT_EQ(same->inward, hit.inward);
    }
  }
}

/// First hit, by a search of all triangles.
std::optional<MeshHit> first_of_all(const DeformingBody& body, const Vec3& from, const Vec3& to) {
  std::optional<MeshHit> first;
  const auto& triangles = body.after().triangles();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Corners was, is;
    for (std::size_t k = 0; k < 3; ++k) {
      was[k] = body.before().vertices()[to_index(triangles[t][k])];
      is[k] = body.after().vertices()[to_index(triangles[t][k])];
    }
    for (const auto& [share, inward] : passes(was, is, from, to))
      if (!first || share < first->share) first = MeshHit{share, static_cast<int>(t), inward};
  }
  return first;
}

TEST(DeformingBody, FindsTheFirstTriangleOnTheWay) {
  DeformingBody body(bending(torus(0.5, 0.2, 24, 12), 4, 10));
  Random random;
  int found = 0;
  for (const double t : {0.0, 0.05, 0.1, 0.25}) {
    body.move(t, t + 0.05);
    for (int n = 0; n < 500; ++n) {
      const Vec3 from = random.point(0.8), to = from + random.point(0.2);
      const auto first = body.first_hit(from, to), want = first_of_all(body, from, to);
      ASSERT_EQ(first.has_value(), want.has_value());
      if (!first) continue;
      ++found;
      EXPECT_EQ(first->share, want->share);
      EXPECT_EQ(first->inward, want->inward);
      EXPECT_EQ(body.hits(from, to).front().share, first->share);
    }
  }
  EXPECT_GT(found, 100);
}

// A point that is outside before and inside after has passed the surface, and no point slips in
// between two triangles.
TEST(DeformingBody, NothingComesInWithoutAHit) {
  DeformingBody body(bending(torus(0.5, 0.2, 24, 12), 3, 10));
  body.move(0, 0.1);
  Random random;
  int came_in = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 from = random.point(0.8), to = from + random.point(0.1);
    const bool inside_before = body.before().nearest(from).distance < 0,
               inside_after = body.after().nearest(to).distance < 0;
    if (inside_before == inside_after) continue;
    ++came_in;
    EXPECT_TRUE(body.first_hit(from, to)) << n;
  }
  EXPECT_GT(came_in, 500);
}

TEST(DeformingBody, IsWhatShapeAtSaysAtEitherEnd) {
  const Collider collider = bending(torus(0.5, 0.2, 12, 8), 4, 10);
  DeformingBody body(collider);
  Random random;
  for (const double t : {0.0, 0.1, 0.13, 0.31, 0.2, 0.5}) {  // in order, and out of order
    body.move(t, t + 0.1);
    const Shape before = shape_at(collider, t), after = shape_at(collider, t + 0.1);
    for (int n = 0; n < 100; ++n) {
      const Vec3 p = random.point(1.5);
      EXPECT_NEAR(body.before().nearest(body.local_before(p)).distance, surface(before, p).distance,
                  1e-14);
      EXPECT_EQ(surface(body.body(), p).distance, surface(after, p).distance);
      EXPECT_NEAR((body.world(body.local(p)) - p).norm(), 0, 1e-14);
    }
  }
}

// Where the body turns as a whole, things fixed to its triangles turn with it.
TEST(DeformingBody, FramesOfARigidMotionCarryAsItDoes) {
  const Triangles shape = torus(0.5, 0.2, 12, 8);
  Collider collider{.shape = MeshBody{shape.mesh(), {0.1, 0.2, 0.3}}};
  const Motion motion{.velocity = {1, 0, 0.5}, .spin = {0.2, 1, 0}, .pivot = {0.1, 0, 0}};
  auto frames = std::make_shared<BodyFrames>();
  frames->fps = 8;
  for (int k = 0; k < 4; ++k) {
    auto& x = frames->places.emplace_back();
    for (const Vec3& p : shape.vertices)
      x.push_back(motion.moved(Vec3(p + Vec3(0.1, 0.2, 0.3)), k / 8.0) - Vec3(0.1, 0.2, 0.3));
  }
  collider.frames = frames;
  Random random;
  std::vector<Vec3> points;
  for (int n = 0; n < 200; ++n) points.push_back(random.point(1));
  Collider rigid = collider;
  rigid.frames = nullptr;
  rigid.motion = motion;
  const auto want = carried(rigid, 0.125, 0.125, points),
             got = carried(collider, 0.125, 0.125, points);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR((got[i] - want[i]).norm(), 0, 1e-13);
}

}  // namespace
}  // namespace taut::deforming_body_test
