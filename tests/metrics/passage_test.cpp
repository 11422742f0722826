// Passages through moving and turning colliders, against ten thousand sample points on each path.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/model/index.hpp"
#include "tests/metrics/measured.hpp"

namespace taut::passage_test {
namespace {

Vec3 center(const Collider& collider) {
  const auto* ball = std::get_if<Ball>(&collider.shape);
  return ball ? ball->center : Vec3(Vec3::Zero());
}

// A vertex that is outside at the start of a straight path in the collider's frame enters by the
// first side on its path and leaves by another. The path is sampled at ten thousand points.
TEST(Definitions, Tunnelling) {
  Draw draw(5);
  Scene scene = sheet(8);
  scene.pins = {3};
  scene.steps = 12;
  scene.colliders = {
      {.shape = Ball{.center = {0.2, 0.1, 0.3}, .radius = 0.4},
       .motion = {.velocity = {0.3, 1, -0.5}}},
      {.shape =
           Box{.center = {0.7, -0.2, 0.6},
               .half_extents = {0.15, 0.3, 0.25},
               .rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()))},
       .motion = {.velocity = {0, 0.4, 1}, .spin = {0.2, -0.7, 0.4}, .pivot = {1, 0, 0}}},
      {.shape = Capsule{.from = {0.9, 0.2, 0.1}, .to = {1.1, -0.5, 0.4}, .radius = 0.25},
       .motion = {.velocity = {-0.4, 0, 0.6}, .spin = {0.9, 0.3, -0.6}, .pivot = {1, 0, 0}}}};
  std::vector<State> states(13, scene.start);
  for (std::size_t i = 0; i < scene.start.x.size(); ++i)  // no vertex starts inside
    for (State& state : states) do
        state.x[i] = Vec3(0.5, 0, 0.5) + draw.vector(1.2);
      while (&state == &states[0] && std::ranges::any_of(scene.colliders, [&](const Collider& c) {
        return signed_distance(c.shape, state.x[i]) < 0;
      }));
  scene.start = states[0];
  int events = 0;
  std::vector<bool> beyond(scene.start.x.size());
  for (const Collider& collider : scene.colliders) {
    const auto local = [&](int step, std::size_t i) -> Vec3 {
      const Shape shape = shape_at(collider, step * scene.dt);
      const Vec3& x = states[to_index(step)].x[i];
      if (const auto* ball = std::get_if<Ball>(&shape)) return x - ball->center;
      if (std::holds_alternative<Capsule>(shape))  // with the axis as at the start
        return collider.motion.pivot +
               collider.motion.rotation(step * scene.dt).inverse() *
                   (x - collider.motion.displacement(step * scene.dt) - collider.motion.pivot);
      const Box& box = std::get<Box>(shape);
      return box.rotation.inverse() * (x - box.center);
    };
    const auto side = [&](const Vec3& p) -> Vec3 {  // outward normal at a point of the surface
      const auto* box = std::get_if<Box>(&collider.shape);
      if (!box) return surface(collider.shape, p + center(collider)).normal;
      Eigen::Index axis;
      (p.cwiseAbs() - box->half_extents).maxCoeff(&axis);
      return Vec3::Unit(axis) * (p[axis] > 0 ? 1 : -1);
    };
    const auto inside = [&](const Vec3& p) {
      const auto* box = std::get_if<Box>(&collider.shape);
      return box ? (p.cwiseAbs() - box->half_extents).maxCoeff() < 0
                 : signed_distance(collider.shape, p + center(collider)) < 0;
    };
    for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
      if (i == 3) continue;
      bool in = false, through = false;
      Vec3 entry = Vec3::Zero();
      for (int step = 1; step <= scene.steps; ++step) {
        const Vec3 from = local(step - 1, i), way = local(step, i) - from;
        for (int k = 1; k <= 10000; ++k) {
          const Vec3 p = from + k / 10000.0 * way;
          if (inside(p) == in) continue;
          in = !in;
          if (in) entry = side(p);
          if (!in && entry.dot(side(p)) < 0) {
            through = !through;
            ++events;
          }
        }
      }
      if (through) beyond[i] = true;
    }
  }
  const Values v = measure(scene, [&](int step) { return states[to_index(step)]; });
  const auto count = static_cast<double>(std::ranges::count(beyond, true));
  EXPECT_GT(events, 40);
  EXPECT_EQ(v.at("tunnelling.events"), events);
  EXPECT_EQ(v.at("tunnelling.count"), count);
  EXPECT_NEAR(v.at("tunnelling.share"), count / 63, 1e-15);
}

}  // namespace
}  // namespace taut::passage_test
