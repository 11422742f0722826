// Newton's method for implicit Euler against a second program: dense, from the equations.
#include <gtest/gtest.h>

#include <cmath>

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
