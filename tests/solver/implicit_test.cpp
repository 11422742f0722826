// Newton's method for implicit Euler against a second program: dense, from the equations.
#include <gtest/gtest.h>

#include <cmath>

#include "core/reference/implicit_step.hpp"
#include "tests/solver/elastic_step.hpp"
#include "tests/support/cloths.hpp"

namespace taut::implicit_test {
namespace {

constexpr std::array kSoft{800.0, 300.0, 50.0};
const std::string kSoftText = "structural=800,shear=300,bend=50";

TEST(Implicit, AgreesWithDenseNewtonOnAnIrregularMesh) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Scene scene = irregular_net(seed);
    const State mine = after_one_step(scene, "implicit:" + kSoftText);
    const ElasticStep step(scene, kSoft);
    const std::vector<Vec3> exact = step.minimum();
    EXPECT_LT(step.gradient(exact).norm(), 1e-10);
    EXPECT_LT(step.gradient(mine.x).norm(), 2e-9);
    EXPECT_LT(largest_distance(mine.x, exact), 1e-9) << "seed " << seed;
    EXPECT_GT(largest_distance(exact, scene.start.x), 1e-3);  // it moves
    for (std::size_t i = 0; i < exact.size(); ++i)
      EXPECT_LT((mine.v[i] - (mine.x[i] - scene.start.x[i]) / scene.dt).norm(), 1e-9);
  }
}

TEST(Implicit, ConjugateGradientsFindTheSameStep) {
  const Scene scene = irregular_net(4);
  const State cg = after_one_step(scene, "implicit:linear=cg," + kSoftText);
  const State factor = after_one_step(scene, "implicit:linear=ldlt," + kSoftText);
  EXPECT_LT(largest_distance(cg.x, factor.x), 1e-9);
}

/// One linear system about x_t: H p = -g with the springs' Hessian clamped.
TEST(Implicit, OneIterationWithoutLineSearchIsBaraffAndWitkinsStep) {
  const Scene scene = irregular_net(5);
  const ElasticStep step(scene, kSoft);
  const std::vector<Vec3> linear = step.moved(scene.start.x, step.newton_direction(scene.start.x));
  const State mine = after_one_step(scene, "implicit:iterations=1,line-search=off," + kSoftText);
  EXPECT_LT(largest_distance(mine.x, linear), 1e-9);
  EXPECT_GT(largest_distance(step.minimum(), linear), 1e-5);  // it is not the minimum
  // where the whole way would raise the energy, too
  Scene thrown = scene;
  for (Vec3& v : thrown.start.v) v *= 100;
  const ElasticStep far(thrown, kSoft);
  const std::vector<Vec3> whole = far.moved(thrown.start.x, far.newton_direction(thrown.start.x));
  const auto after_one = [&](const std::string& search) {
    return after_one_step(thrown, "implicit:iterations=1,line-search=" + search + "," + kSoftText)
        .x;
  };
  EXPECT_LT(largest_distance(after_one("off"), whole), 1e-9);
  EXPECT_GT(largest_distance(after_one("on"), whole), 1e-2);
}

/// What convergence is measured against is the step of the scene: with damping, wind and pins that
/// move, each alone and together.
TEST(Implicit, ConvergesToTheMinimumOfTheReference) {
  for (int effects = 0; effects < 8; ++effects) {
    Scene scene = hanging_sheet(5, 4);
    scene.stiffness = {800, 300, 50};
    for (std::size_t i = 1; i < scene.start.v.size(); ++i)
      scene.start.v[i] = {0.3, -0.2, std::sin(static_cast<double>(i))};
    for (const int pin : scene.pins) scene.start.v[to_index(pin)].setZero();
    if ((effects & 1) != 0) scene.damping = 5;
    if ((effects & 2) != 0) scene.wind = Wind{.velocity = {1, 2, 6}, .strength = 2};
    if ((effects & 4) != 0) scene.pin_motions = {{{0}, {.velocity = {0, 0, 2}}}};
    const reference::ImplicitStep step(scene, scene.start, 0, scene.stiffness);
    const auto minimum = step.minimum(scene.start.x);
    EXPECT_EQ(minimum.problem, "");
    std::vector<Vec3> mine = after_one_step(scene, "implicit").x;
    EXPECT_LT(largest_distance(mine, minimum.x), 1e-8) << effects;
    // pins, which nobody moves, count neither as near nor as mass
    std::vector<Vec3> shifted = mine;
    for (std::size_t i = 0; i < mine.size(); ++i) shifted[i] += Vec3(0.3, 0, 0.4);
    for (const int pin : scene.pins) shifted[to_index(pin)] = mine[to_index(pin)];
    EXPECT_NEAR(step.square_distance(shifted, mine), 0.25, 1e-12);
  }
}

/// A frame that moves steadily is a frame at rest, also where pins go several links a step: a cape
/// that is linearised with pins ahead of it ends upside down over them.
TEST(EverySolver, SeesAClothThatMovesSteadilyWithItsPinsAsOneAtRest) {
  Scene still = hanging_sheet(5, 5);
  for (std::size_t i = 0; i < still.start.x.size(); ++i) still.start.v[i] = {0, 0, 0.3};
  for (const int pin : still.pins) still.start.v[to_index(pin)].setZero();
  for (const char* solver : {"implicit", "implicit:linear=cg", "pd", "admm", "vbd", "avbd",
                             "mass-spring", "jakobsen:precision=double", "xpbd:precision=double"}) {
    const State at_rest = simulate(still, solver, 30);
    for (const double speed : {2.0, 6.0, 20.0, 40.0}) {
      const Vec3 velocity(0, -speed, 0);
      Scene moving = still;
      moving.pin_motions = {{.vertices = still.pins, .motion = {.velocity = velocity}}};
      for (Vec3& v : moving.start.v) v += velocity;
      State end = simulate(moving, solver, 30);
      for (Vec3& x : end.x) x -= 30 * still.dt * velocity;
      EXPECT_LT(largest_distance(end.x, at_rest.x), 1e-9) << solver << ", " << speed << " m/s";
    }
  }
}

/// In equilibrium tension is fixed by the weight, so strain is tension / (K r).
TEST(Implicit, StrainOfAHungSheetIsInverseToItsStiffness) {
  Scene scene = hanging_sheet(16, 16, {true, true, false});
  scene.dt = 0.25;
  const auto strain = [&](const std::string& k) {
    const State s =
        simulate(scene, "implicit:iterations=200,structural=" + k + ",shear=" + k + ",bend=0", 60);
    double sum = 0;
    for (const Link& l : scene.links)
      sum += std::pow((s.x[to_index(l.b)] - s.x[to_index(l.a)]).norm() / l.rest - 1, 2);
    return std::sqrt(sum / static_cast<double>(scene.links.size()));
  };
  const double soft = strain("1e3"), stiff = strain("1e5");
  EXPECT_GT(soft, 1e-4);
  EXPECT_NEAR(stiff * 1e5 / (soft * 1e3), 1, 0.02);
}

}  // namespace
}  // namespace taut::implicit_test
