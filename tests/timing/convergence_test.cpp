// Error over iterations inside one step: the exact step, gaps and rates against other programs and
// closed forms.
#include "experiments/timing/convergence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/reference/closed_forms.hpp"
#include "tests/solver/elastic_step.hpp"
#include "tests/support/cloths.hpp"

namespace taut::convergence_test {
namespace {

/// By one solver, from the scene's start.
Convergence of_one(const Scene& scene, const std::string& solver, int most) {
  return converge(scene, scene.start, 0, {solver}, most).front();
}

TEST(Convergence, ExactStepOfSpringsAgreesWithADenseNewtonProgram) {
  const reference::Stiffness soft{800, 300, 50};
  for (const unsigned seed : {11u, 12u}) {
    const Scene scene = irregular_net(seed);
    const ElasticStep dense(scene, soft);
    const reference::ImplicitStep step(scene, scene.start, 0, soft);
    const auto exact = step.minimum(scene.start.x);
    ASSERT_EQ(exact.problem, "");
    EXPECT_LT(largest_distance(exact.x, dense.minimum()), 1e-9);
    EXPECT_LT(largest_distance(step.prediction(), dense.y()), 1e-15);
    const double energy = dense.energy(scene.start.x);
    EXPECT_NEAR(step.energy(scene.start.x), energy, 1e-12 * energy);
    EXPECT_NEAR(step.residual(scene.start.x), dense.gradient(scene.start.x).norm(), 1e-9);
  }
}

TEST(Convergence, GapIsThatOfTheEnergyAndNewtonsMethodClosesIt) {
  const Scene scene = irregular_net(11);
  const std::string springs = "structural=800,shear=300,bend=50";
  const ElasticStep dense(scene, {800, 300, 50});
  const std::vector<Vec3> exact = dense.minimum();
  const auto gap = [&](const std::vector<Vec3>& x) {
    return (dense.energy(x) - dense.energy(exact)) /
           (dense.energy(dense.y()) - dense.energy(exact));
  };
  const Convergence vbd = of_one(scene, "vbd:" + springs, 8);
  ASSERT_EQ(vbd.points.size(), 6u);  // 1 2 3 4 6 8
  for (const ConvergencePoint& p : vbd.points) {
    const State at_k =
        after_one_step(scene, "vbd:iterations=" + std::to_string(p.iterations) + "," + springs);
    EXPECT_NEAR(p.gap, gap(at_k.x), 1e-9);
    EXPECT_NEAR(p.residual, dense.gradient(at_k.x).norm(), 1e-9);
  }
  const Convergence newton = of_one(scene, "implicit:" + springs, 64);
  EXPECT_LT(newton.points.back().distance, 1e-10);
  EXPECT_LT(std::abs(newton.points.back().gap), 1e-12);
  EXPECT_GE(reached(newton, 1e-6), 0);
  EXPECT_EQ(reached(vbd, 1e-12), -1);
}

/// All goes along the chain: strains shrink as the sweep's matrix says.
TEST(Convergence, GaussSeidelAndJacobiContractOnAStraightChainAsPrinted) {
  constexpr int kLinks = 8;
  const Scene scene = hanging_sheet(1, kLinks + 1, {true, false, false}, Lumping::equal);
  using reference::Sweep;
  for (const auto& [method, sweep] :
       {std::pair("gauss-seidel", Sweep::gauss_seidel), std::pair("jacobi", Sweep::jacobi)}) {
    const Convergence all = of_one(
        scene,
        "jakobsen:projection=exact,precision=double,order=mesh,method=" + std::string(method), 512);
    ASSERT_EQ(all.problem, "");
    const double rate = reference::chain_radius(kLinks, sweep);
    EXPECT_NEAR(1 - all.contraction, 1 - rate, 0.01 * (1 - rate)) << method;
    EXPECT_EQ(all.floor, 0) << method;
  }
}

TEST(Convergence, ProjectiveDynamicsContractsAsItsFormulaSays) {
  constexpr int kLinks = 9;
  Scene scene;
  scene.dt = 1.0 / 64, scene.steps = 1, scene.gravity = Vec3::Zero();
  for (int i = 0; i <= kLinks; ++i) {
    const double shape = i == kLinks ? 0 : std::sin(std::numbers::pi * i / kLinks);
    scene.start.x.emplace_back(0.105 * i, 0, 0);
    scene.start.v.emplace_back(0, 1e-4 * shape, 0);
    scene.mesh.mass.push_back(0.01);
    if (i > 0) scene.links.push_back({i - 1, i, 0.1, Family::structural});
  }
  scene.mesh.rest = scene.start.x;
  scene.pins = {0, kLinks};
  const double lambda = 2 - 2 * std::cos(std::numbers::pi / kLinks);
  const double s = scene.dt * scene.dt * 1e3 / 0.01;
  const double rate = s * lambda / 1.05 / (1 + s * lambda);
  const Convergence pd = of_one(scene, "pd:structural=1e3", 96);
  EXPECT_NEAR(pd.contraction, rate, 0.01 * rate);
}

/// Projection along the directions of the moment depends on the order: not the nearest placement.
TEST(Convergence, GaussSeidelOfRigidLinksEndsOnAFloorAndAdmmDoesNot) {
  Scene scene = hanging_sheet(1, 6, {true, false, false});
  for (std::size_t i = 1; i < scene.start.v.size(); ++i)
    scene.start.v[i] = {3, 0, static_cast<double>(i % 2)};
  const Convergence floored =
      of_one(scene, "jakobsen:projection=exact,precision=double,order=mesh", 4096);
  ASSERT_EQ(floored.problem, "");
  EXPECT_GT(floored.floor, 1e-7);
  EXPECT_LT(floored.points.back().stretch, 1e-12);
  const Convergence admm = of_one(scene, "admm", 4096);
  EXPECT_LT(admm.points.back().distance, 1e-9);
  EXPECT_LT(admm.points.back().distance, 1e-3 * floored.floor);
}

/// Its distance hardly falls, but it is on its way.
TEST(Convergence, AFrozenSolverIsOnNoFloor) {
  Scene scene = hanging_sheet(1, 6, {true, false, false});
  for (std::size_t i = 1; i < scene.start.v.size(); ++i) scene.start.v[i] = {3, 0, 0};
  const Convergence pd = of_one(scene, "pd:structural=1e9", 64);
  ASSERT_EQ(pd.problem, "");
  EXPECT_GT(pd.points.back().distance, 0.9 * pd.points[3].distance);
  EXPECT_GT(pd.contraction, 0.999);
  EXPECT_EQ(pd.floor, 0);
}

TEST(Convergence, EachSolverHasTheExactStepOfItsOwnLinks) {
  const Scene scene = irregular_net(11);
  const std::vector<std::string> solvers{"pd:structural=800", "vbd:structural=400",
                                         "admm:links=elastic,structural=800"};
  const std::vector<Convergence> all = converge(scene, scene.start, 0, solvers, 8);
  ASSERT_EQ(all.size(), solvers.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Convergence alone = of_one(scene, solvers[i], 8);
    EXPECT_EQ(all[i].solver, alone.solver);
    EXPECT_EQ(all[i].exact_residual, alone.exact_residual);
    for (std::size_t k = 0; k < alone.points.size(); ++k)
      EXPECT_EQ(all[i].points[k].distance, alone.points[k].distance) << solvers[i];
  }
}

TEST(Convergence, SaysWhatItCannotCompare) {
  const Scene scene = hanging_sheet(1, 4, {true, false, false});
  EXPECT_FALSE(of_one(scene, "mass-spring", 4).refused.empty());
  Scene elastic = scene;
  const auto of = [&](const char* solver) {
    return stiffness_of(elastic, parse_solver(solver))[0];
  };
  EXPECT_TRUE(std::isinf(of("admm")));
  EXPECT_EQ(of("admm:links=elastic,structural=7"), 7);
  EXPECT_EQ(of("xpbd:structural=0.01"), 100);
  elastic.stiffness = {500, 500, 500};
  EXPECT_EQ(of("xpbd:structural=0.01"), 500) << "the cloth's";
  EXPECT_EQ(of("admm"), 500);
  EXPECT_EQ(of("pd:structural=7,material=own"), 7);
}

}  // namespace
}  // namespace taut::convergence_test
