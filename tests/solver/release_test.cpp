// Pins that release the cloth, in every solver: the position and the velocity with which vertices
// become free, and that nothing else changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/model/collider.hpp"
#include "core/model/index.hpp"
#include "core/model/solver.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/cloths.hpp"

namespace taut::release_test {
namespace {

/// Sheet on two pins, one of which moves. After 12 steps both are released, or only the first.
Scene let_go(std::vector<int> vertices) {
  Scene scene = hanging_sheet(6, 6, {true, true, false});
  Motion aside;
  aside.velocity = Vec3(0.2, 0.1, 0.3);
  scene.pin_motions = {{{5}, aside}};
  scene.start.v[5] = aside.velocity;
  scene.releases = {{12, std::move(vertices)}};
  return scene;
}

std::unique_ptr<Solver> made(const Scene& scene, const std::string& text) {
  const SolverChoice choice = parse_solver(text);
  auto solver = choice.entry->make(scene, choice.params);
  solver->load(scene.start);
  return solver;
}

State after(Solver& solver, const Scene& scene, int from, int to) {
  for (int n = from; n < to; ++n) solver.step(n * scene.dt, scene.dt);
  State state;
  solver.store(state);
  return state;
}

const std::vector<std::string> kEverySolver{"jakobsen:precision=double,substeps=3",
                                            "jakobsen:precision=double,substeps=1,order=mesh",
                                            "xpbd:precision=double",
                                            "mass-spring",
                                            "implicit",
                                            "pd:precision=double",
                                            "admm:precision=double",
                                            "vbd:precision=double",
                                            "avbd:precision=double",
                                            "bullet",
                                            "bullet-deformable"};

TEST(Release, APinHoldsToTheBoundaryAndMovesBehindIt) {
  const Scene scene = let_go({0, 5});
  for (const std::string& text : kEverySolver) {
    const auto solver = made(scene, text);
    const State held = after(*solver, scene, 0, 12);
    EXPECT_LT((held.x[0] - scene.start.x[0]).norm(), 1e-6) << text;
    EXPECT_LT((held.x[5] - pin_position(scene, 5, 12 * scene.dt)).norm(), 1e-6) << text;
    EXPECT_LT((held.v[5] - scene.start.v[5]).norm(), 1e-5) << text;
    const State free = after(*solver, scene, 12, 13);
    EXPECT_GT((free.x[0] - held.x[0]).norm(), 1e-4) << text;
    EXPECT_GT((free.x[5] - pin_position(scene, 5, 13 * scene.dt)).norm(), 1e-4) << text;
  }
}

/// After a release the remaining pins alone determine the motion: a scene that never had the other
/// pins, started from the state at the release, moves the same. avbd keeps multipliers and only
/// follows nearly, so that it is left out.
TEST(Release, BehindItIsTheSceneWithThePinsThatAreLeft) {
  const Scene scene = let_go({0});
  Scene rest = scene;
  rest.releases.clear();
  rest.pins = {5};
  for (std::string text : kEverySolver) {
    if (text.starts_with("avbd")) continue;
    // the adaptive start depends on the step before
    if (text.starts_with("vbd")) text += ",start=inertia";
    const auto whole = made(scene, text), alone = made(rest, text);
    alone->load(after(*whole, scene, 0, 12));
    const State a = after(*whole, scene, 12, 30), b = after(*alone, rest, 12, 30);
    EXPECT_LT(largest_distance(a.x, b.x), text.starts_with("bullet-d") ? 1e-7 : 1e-9) << text;
    EXPECT_GT((a.x[0] - scene.start.x[0]).norm(), 0.01) << text;
  }
}

/// Releasing a vertex without links beside a cloth in contact does not affect the cloth: the solver
/// keeps its multipliers and contact forces from step to step.
TEST(Release, WhatIsKeptGoesOn) {
  Scene scene = hanging_sheet(6, 6, {true, true, false});
  scene.mesh.grid.reset();
  scene.mesh.rest.emplace_back(3, 0, 0);
  scene.mesh.mass.push_back(0.01);
  scene.start.x.emplace_back(3, 0, 0);
  scene.start.v.emplace_back(Vec3::Zero());
  scene.pins.push_back(36);
  scene.colliders.push_back({.shape = Ball{{0.5, -0.6, 0.15}, 0.2}, .friction = 0.3});
  Scene held = scene;
  scene.releases = {{30, {36}}};
  std::vector<std::string> solvers = kEverySolver;
  solvers.insert(solvers.end(), {"admm:precision=double,multipliers=keep,iterations=4",
                                 "implicit:multipliers=keep,iterations=2", "implicit:start=inertia",
                                 "jakobsen:precision=double,contact=freeze",
                                 "jakobsen:precision=double,faces=on"});
  for (const std::string& text : solvers) {
    const auto whole = made(scene, text), same = made(held, text);
    State a = after(*whole, scene, 0, 40), b = after(*same, held, 0, 40);
    EXPECT_LT(a.x[36].y(), -0.1) << text;
    a.x.pop_back();
    b.x.pop_back();
    EXPECT_LT(largest_distance(a.x, b.x), text.starts_with("bullet-d") ? 1e-6 : 1e-10) << text;
  }
}

/// Pins may be inside a body. Once they let go, they are moved to its surface and the cloth with
/// them: neither their depth nor strain becomes velocity, however short the step.
TEST(Release, WhatABodyHeldInsideLeavesItWithoutVelocity) {
  const Box box{.center = {0.5, -0.04, 0}, .half_extents = {0.6, 0.1, 0.06}};
  const MeshBody body{.mesh = box_of_triangles(box.half_extents).mesh(), .center = box.center};
  const Ball ball{{0.5, 0.4, 0}, 0.5};
  for (const Shape& shape : {Shape(box), Shape(body), Shape(ball)})
    for (const std::string& text : kEverySolver) {
      // its implicit scheme predicts contact with explicit springs (bullet_ref/README.md)
      if (text == "bullet-deformable" && std::holds_alternative<Ball>(shape)) continue;
      double ways[2];
      for (const int finer : {1, 4}) {
        Scene scene = hanging_sheet(6, 6, {true, true, false});
        for (Vec3& x : scene.start.x) x.z() += 0.03;
        scene.pins = {0, 1, 2, 3, 4, 5};
        scene.gravity.setZero();
        scene.thickness = 0.005;
        scene.colliders = {{.shape = shape}};
        for (int i = 6; i < 36; ++i) scene.start.x[to_index(i)].y() -= 0.2;
        scene.mesh.rest = scene.start.x;
        for (Link& link : scene.links)
          link.rest = (scene.start.x[to_index(link.b)] - scene.start.x[to_index(link.a)]).norm();
        scene.dt /= finer;
        scene.releases = {{4 * finer, scene.pins}};
        const auto solver = made(scene, text);
        const State state = after(*solver, scene, 0, 36 * finer);
        double& way = ways[finer / 4] = 0;
        for (std::size_t i = 0; i < 36; ++i) {
          way = std::max(way, (state.x[i] - scene.start.x[i]).norm());
          EXPECT_GT(surface(shape, state.x[i]).distance, -1e-3) << text << " vertex " << i;
        }
        EXPECT_GT(way, 0.02) << text << " at a " << type_name(shape);
        EXPECT_LT(way, 0.2) << text << " at a " << type_name(shape);
      }
      // On the ball each vertex leaves by its own way, which leaves some strain.
      const double left = std::holds_alternative<Ball>(shape) ? 0.05 : 0.02;
      EXPECT_NEAR(ways[0], ways[1], left) << text << " at a " << type_name(shape);
    }
}

TEST(Release, LoadBeginsAnewWithAllPins) {
  const Scene scene = let_go({0, 5});
  for (const std::string& text : kEverySolver) {
    const auto solver = made(scene, text);
    const State once = after(*solver, scene, 0, 20);
    solver->load(scene.start);
    const State again = after(*solver, scene, 0, 20);
    EXPECT_EQ(largest_distance(once.x, again.x), 0) << text;
  }
}

TEST(Release, SubstepsAreVisitedBeforeAndBehindIt) {
  const Scene scene = let_go({0, 5});
  const auto solver = made(scene, "jakobsen:substeps=3");
  int visits = 0;
  solver->visit_substeps([&](double) { ++visits; });
  after(*solver, scene, 0, 20);
  EXPECT_EQ(visits, 2 * 20);
}

/// Contact forces are kept: a cloth that lies on a plane, held by one corner, stays at rest.
TEST(Release, AClothThatLiesLiesOn) {
  Scene scene = hanging_sheet(6, 6, {true, true, false});
  for (auto* points : {&scene.mesh.rest, &scene.start.x})
    for (Vec3& x : *points) x = Vec3(x.x(), 0, x.y());
  scene.colliders.push_back({.shape = Plane{}, .friction = 0.5});
  scene.pins = {0};
  scene.releases = {{20, {0}}};
  for (const std::string text : {"jakobsen", "vbd", "avbd", "pd", "admm", "implicit"}) {
    const auto solver = made(scene, text);
    const State held = after(*solver, scene, 0, 20), free = after(*solver, scene, 20, 40);
    EXPECT_LT(largest_distance(held.x, free.x), 1e-4) << text;
  }
}

TEST(Release, StagesLoseTheirPinsOneAfterTheOther) {
  Scene scene = let_go({0});
  scene.releases.push_back({20, {5}});
  const std::vector<Scene> all = stages(scene);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].pins, (std::vector{0, 5}));
  EXPECT_EQ(all[1].pins, std::vector{5});
  EXPECT_EQ(all[1].pin_motions.size(), 1u);
  EXPECT_TRUE(all[2].pins.empty());
  EXPECT_TRUE(all[2].pin_motions.empty());
  for (const Scene& stage : all) EXPECT_TRUE(stage.releases.empty());
  EXPECT_TRUE(!is_pinned(scene, 0) && !is_pinned(scene, 5));
  EXPECT_EQ(pins_at(scene, 20 * scene.dt), std::vector{5});
  EXPECT_NE(content(scene), content(all[0]));
}

}  // namespace
}  // namespace taut::release_test
