// Bullet's deformable body: Hooke springs, backward Euler.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/io/scene_io.hpp"
#include "core/model/solver.hpp"
#include "experiments/case/run_case.hpp"
#include "tests/support/cloths.hpp"

namespace taut::deformable_test {
namespace {

Scene sheet(const SheetShape& shape, const LinkChoice& links) {
  Scene scene;
  scene.mesh = make_sheet(shape);
  scene.links = grid_links(scene.mesh, links);
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.dt = 1.0 / 64;
  return scene;
}

State run(const Scene& scene, const std::string& text, int steps) {
  const SolverChoice choice = parse_solver(text);
  EXPECT_EQ(choice.entry->unsupported(scene, choice.params), std::vector<std::string>{});
  return simulate(scene, text, steps);
}

double distance(const State& a, const State& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i)
    largest = std::max({largest, (a.x[i] - b.x[i]).norm(), (a.v[i] - b.v[i]).norm()});
  return largest;
}

TEST(BulletDeformable, AHangingChainStretchesByTheWeightBelow) {
  constexpr int kLinks = 8;
  constexpr double kMass = 0.01, kStiffness = 50;  // kg per vertex, N/m
  Scene chain = sheet({.nu = 1,
                       .nv = kLinks + 1,
                       .height = 1,
                       .mass = kMass * (kLinks + 1),
                       .lumping = Lumping::equal},
                      {.structural = true});
  chain.pins = {0};
  chain.damping = 2;
  const State state = run(chain, "bullet-deformable:stiffness=50", 1280);
  for (int j = 1; j <= kLinks; ++j) {
    const auto i = static_cast<std::size_t>(j);
    const double stretch = (state.x[i] - state.x[i - 1]).norm() - 1.0 / kLinks;
    EXPECT_NEAR(stretch, (kLinks - j + 1) * kMass * 9.81 / kStiffness, 1e-7) << "link " << j;
  }
  const double tip = -state.x.back().y() - 1;
  EXPECT_NEAR(tip, kMass * 9.81 * kLinks * (kLinks + 1) / (2 * kStiffness), 1e-7);
}

// Found by fuzzing: a vertex is pulled beyond the cells of the colliders' distance fields, where
// Bullet would read out of bounds.
TEST(BulletDeformable, AVertexBeyondDistanceFieldsEndsTheCase) {
  const Scene scene = load_scene(TAUT_SOURCE_DIR "/tests/fuzz/corpus/scene/good-flies-apart.toml");
  const Status status =
      run_case(scene, parse_solver("bullet-deformable:stiffness=1000,substeps=23")).record.status;
  EXPECT_EQ(status.kind, Status::Kind::exploded);
  EXPECT_EQ(status.reason, Reason::box);
  Scene ball = load_scene(TAUT_SOURCE_DIR "/experiments/scenes/ball.toml", {"cloth.grid=[4, 4]"});
  ball.start.x.back() = Vec3(1e12, 0, 0);
  for (const char* text : {"bullet", "bullet-deformable"}) {
    const SolverChoice choice = parse_solver(text);
    const auto solver = choice.entry->make(ball, choice.params);
    solver->load(ball.start);
    EXPECT_THROW(solver->step(0, ball.dt), SolverFailure) << text;
  }
}

// Without springs both schemes are symplectic Euler, so that wind, damping, gravity and moving pins
// can be compared with our solver up to rounding.
TEST(BulletDeformable, WithoutSpringsItMovesLikeOurs) {
  Scene scene = sheet({.nu = 6, .nv = 5, .width = 1, .height = 1, .mass = 0.2}, {false});
  scene.wind = Wind{.velocity = {1, 0.3, 2}, .strength = 0.1};
  scene.damping = 0.5;
  scene.gravity = {0.1, -3.7, 0.2};
  scene.start.v.assign(scene.start.v.size(), Vec3(0.1, 0.2, 0.3));
  scene.pins = {0, 5};
  scene.pin_motions = {{.vertices = {0}, .motion = {.velocity = {0.1, 0, 0.2}}}};
  const State ours = run(scene, "jakobsen:precision=double,substeps=2", 64);
  EXPECT_LT(distance(run(scene, "bullet-deformable:substeps=2", 64), ours), 1e-10);
  EXPECT_LT(distance(run(scene, "bullet-deformable:substeps=2,implicit=false", 64), ours), 1e-10);
}

TEST(BulletDeformable, AHangingSheetStaysFiniteAndItsPinsStay) {
  Scene scene = sheet({.nu = 9, .nv = 9, .width = 1, .height = 1, .v = Vec3::UnitZ(), .mass = 0.2},
                      {.structural = true, .shear = true});
  scene.pins = {0, 8};
  const State state = run(scene, "bullet-deformable", 192);
  double lowest = 0;
  for (const Vec3& x : state.x) {
    ASSERT_TRUE(x.allFinite());
    lowest = std::min(lowest, x.y());
  }
  EXPECT_LT(lowest, -0.7) << "it came down from level";
  EXPECT_GT(lowest, -1.6);
  for (const int pin : scene.pins) {
    const auto i = static_cast<std::size_t>(pin);
    EXPECT_EQ(state.x[i], scene.start.x[i]);
  }
}

TEST(BulletDeformable, ExplicitOnAPlaneTheClothRestsAtItsThickness) {
  Scene scene =
      sheet({.nu = 6, .nv = 6, .width = 0.5, .height = 0.5, .v = Vec3::UnitZ(), .mass = 0.2},
            {.structural = true, .shear = true});
  for (Vec3& x : scene.start.x) x.y() = 0.05;
  scene.colliders = {{.shape = Plane{}}};
  scene.thickness = 0.02;
  const State state = run(scene, "bullet-deformable:implicit=false,stiffness=100,substeps=16", 96);
  for (const Vec3& x : state.x) EXPECT_NEAR(x.y(), scene.thickness, 1e-6);
}

TEST(BulletDeformable, RestartingGivesTheSameBits) {
  Scene scene = sheet({.nu = 6, .nv = 6, .width = 1, .height = 1, .mass = 0.2}, {.shear = true});
  scene.pins = {0};
  const SolverChoice choice = parse_solver("bullet-deformable");
  const auto solver = choice.entry->make(scene, choice.params);
  State first, second;
  for (State* state : {&first, &second}) {
    solver->load(scene.start);
    for (int n = 0; n < 32; ++n) solver->step(n * scene.dt, scene.dt);
    solver->store(*state);
  }
  EXPECT_EQ(first.x, second.x);
  EXPECT_EQ(first.v, second.v);
}

TEST(BulletDeformable, RefusesSelfCollision) {
  Scene scene = sheet({.nu = 3, .nv = 3, .width = 1, .height = 1, .mass = 0.2}, {.shear = true});
  scene.self_collision = SelfCollision{0.01};
  const SolverChoice choice = parse_solver("bullet-deformable");
  EXPECT_EQ(choice.entry->unsupported(scene, choice.params).size(), 1u);
}

}  // namespace
}  // namespace taut::deformable_test
