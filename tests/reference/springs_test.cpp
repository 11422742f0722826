// Springs in explicit steps, beside closed forms and beside SHAKE.
#include "core/reference/springs.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/reference/shake.hpp"

namespace taut::springs_test {
namespace {

using reference::Springs;

constexpr double kG = 9.81;

/// A chain of n links of one metre in all, pinned at its first vertex and let go level.
Scene chain(int n) {
  Scene scene;
  scene.mesh =
      make_sheet({.nu = 1, .nv = n + 1, .height = 1, .mass = 0.1, .lumping = Lumping::equal});
  scene.start.x = scene.mesh.rest;
  for (Vec3& x : scene.start.x) x = {-x.y(), 0, 0};
  scene.start.v.assign(scene.start.x.size(), Vec3::Zero());
  scene.links = grid_links(scene.mesh, {});
  scene.pins = {0};
  scene.dt = 1.0 / 64;
  scene.steps = 64;
  return scene;
}

/// Two vertices without a link that lie on a slope of this angle, which falls towards +x.
Scene on_slope(double angle, double friction) {
  Scene scene;
  scene.mesh = make_sheet({.nu = 1, .nv = 2, .height = 1, .mass = 0.1, .lumping = Lumping::equal});
  const Vec3 start(0, 0.005 / std::cos(angle), 0);
  scene.start = {{start, start}, {Vec3::Zero(), Vec3::Zero()}};
  scene.colliders = {
      {.shape = Plane{{std::sin(angle), std::cos(angle), 0}, 0}, .friction = friction}};
  scene.thickness = 0.005;
  scene.dt = 1.0 / 64;
  scene.steps = 64;
  return scene;
}

State run(const Scene& scene, double seconds, double rigid, double dt) {
  Springs springs(scene, rigid, dt);
  while (springs.time() < seconds - dt / 2) springs.step();
  return springs.state();
}

TEST(Springs, OfAStiffChainMoveAsShakeDoes) {
  const Scene scene = chain(8);
  const auto shake = reference::converged_motion(scene, {0.5}, 1.0 / 1024);
  ASSERT_TRUE(shake.unique);
  double before = 1;
  for (const double rigid : {1e4, 1e5, 1e6}) {
    const State state = run(scene, 0.5, rigid, Springs::longest_step(scene, rigid));
    double worst = 0;
    for (std::size_t i = 0; i < state.x.size(); ++i)
      worst = std::max(worst, (state.x[i] - shake.states[0].x[i]).norm());
    EXPECT_LT(worst, before / 5) << rigid;
    before = worst;
  }
  EXPECT_LT(before, 1e-4);
}

TEST(Springs, OscillateWithTheirClosedForm) {
  Scene scene = chain(1);
  scene.start.x[1] = {0, -1, 0};
  scene.stiffness[0] = 50;
  const double m = scene.mesh.mass[1], w = std::sqrt(50 / m), t = 0.5;
  const State state = run(scene, t, 1e6, 1.0 / 16384);
  EXPECT_NEAR(state.x[1].y(), -1 - m * kG / 50 * (1 - std::cos(w * t)), 1e-6);
  EXPECT_NEAR(state.v[1].y(), -m * kG / 50 * w * std::sin(w * t), 1e-4);
}

TEST(Springs, SlideAndStickAsCoulombSays) {
  const double angle = 0.4, t = 0.5, dt = 1.0 / 65536;
  const auto slid = [&](double friction) {
    const Scene scene = on_slope(angle, friction);
    return (run(scene, t, 1e6, dt).x[0] - scene.start.x[0]).norm();
  };
  EXPECT_NEAR(slid(0), kG * std::sin(angle) * t * t / 2, 1e-4);
  EXPECT_NEAR(slid(0.2), kG * (std::sin(angle) - 0.2 * std::cos(angle)) * t * t / 2, 1e-4);
  EXPECT_LT(slid(std::tan(angle) + 0.01), 1e-9);
}

/// A belt at 1 m/s drags what lies on it with mu g until both are equally fast; a floor that rises
/// at 0.5 m/s meets a vertex above it and carries it along.
TEST(Springs, AreDraggedAndLiftedByBodiesThatMove) {
  Scene belt = on_slope(0, 0.3);
  belt.colliders[0].motion.velocity = {1, 0, 0};
  const double dt = 1.0 / 65536, reached = 1 / (0.3 * kG);
  EXPECT_NEAR(run(belt, 0.25, 1e6, dt).x[0].x(), 0.3 * kG * 0.25 * 0.25 / 2, 1e-4);
  EXPECT_NEAR(run(belt, 0.5, 1e6, dt).x[0].x(), 0.5 - reached / 2, 1e-4);
  Scene floor = on_slope(0, 0);
  floor.start.x[0].y() = 0.1;
  floor.colliders[0].motion.velocity = {0, 0.5, 0};
  EXPECT_NEAR(run(floor, 0.5, 1e6, dt).x[0].y(), 0.25 + 0.005, 1e-9);
}

TEST(Springs, AreLeftWithoutVelocityByAWallThatTheyHit) {
  Scene scene = on_slope(0, 0);
  scene.start.x[0].y() = 0.1;
  const State state = run(scene, 0.5, 1e6, 1.0 / 65536);
  EXPECT_NEAR(state.x[0].y(), 0.005, 1e-12);
  EXPECT_NEAR(state.v[0].y(), 0, 1e-3);
}

TEST(Springs, RefuseWhatTheyDoNotHave) {
  Scene scene = chain(2);
  EXPECT_TRUE(reference::refuse_springs(scene).empty());
  scene.wind.emplace();
  EXPECT_EQ(reference::refuse_springs(scene), std::vector<std::string>{"wind"});
  scene.wind.reset();
  scene.colliders = {{.shape = Ball{Vec3::Zero(), 1}, .motion = {.spin = Vec3::UnitX()}}};
  EXPECT_EQ(reference::refuse_springs(scene),
            std::vector<std::string>{"a body that turns or follows a path"});
}

}  // namespace
}  // namespace taut::springs_test
