// Error over iterations within one step: the exact step, gaps and rates compared with other
// programs and closed forms.
#include "experiments/steps/convergence.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <tuple>

#include "core/io/scene_io.hpp"
#include "core/reference/closed_forms.hpp"
#include "experiments/system/data.hpp"
#include "tests/solver/elastic_step.hpp"
#include "tests/support/cloths.hpp"

namespace taut::convergence_test {
namespace {

/// Convergence of one solver, starting from the scene's start.
Convergence of_one(const Scene& scene, const std::string& solver, int most) {
  return converge(scene, scene.start, 0, {solver}, most).front();
}

TEST(Convergence, ExactStepOfSpringsAgreesWithDenseNewton) {
  const Stiffness soft{800, 300, 50};
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

/// Sheet that hangs by its first row, released at 45 degrees.
Scene let_go(int nu, int nv, const LinkChoice& families) {
  Scene scene = hanging_sheet(nu, nv, families);
  scene.pins.resize(to_index(nu));
  std::iota(scene.pins.begin(), scene.pins.end(), 0);
  const Eigen::AngleAxisd turn(std::numbers::pi / 4, Vec3::UnitX());
  for (Vec3& x : scene.start.x) x = turn * x;
  return scene;
}

/// Nearest placement to y with (|d|^2 - r^2)/2 = 0 for each link. If `cells` is set, each cell of
/// the sheet is rigid and stays a parallelogram. Newton's method on the whole dense KKT system;
/// redundant constraints take the solution of least norm.
std::vector<Vec3> nearest_placement(const Scene& scene, const std::vector<Vec3>& y, bool cells) {
  const std::vector<double> w = inverse_masses(scene);
  std::vector<Vec3> x = scene.start.x;
  const auto n = static_cast<Eigen::Index>(3 * x.size());
  const Grid& grid = *scene.mesh.grid;
  const auto links = static_cast<Eigen::Index>(scene.links.size());
  const Eigen::Index rows = links + (cells ? 3 * (grid.nu - 1) * (grid.nv - 1) : 0);
  Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(rows);
  for (int iteration = 0; iteration < 30; ++iteration) {
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(n, n), jacobian = Eigen::MatrixXd::Zero(rows, n);
    Eigen::VectorXd g(n), c = Eigen::VectorXd::Zero(rows);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double m = scene.mesh.mass[i] / (scene.dt * scene.dt);
      h.diagonal().segment<3>(3 * static_cast<Eigen::Index>(i)).array() += m;
      g.segment<3>(3 * static_cast<Eigen::Index>(i)) = m * (x[i] - y[i]);
    }
    for (Eigen::Index j = 0; j < links; ++j) {
      const Link& l = scene.links[static_cast<std::size_t>(j)];
      const Vec3 d = x[to_index(l.b)] - x[to_index(l.a)];
      c[j] = (d.squaredNorm() - l.rest * l.rest) / 2;
      jacobian.row(j).segment<3>(3 * l.b) = d;
      jacobian.row(j).segment<3>(3 * l.a) = -d;
      for (int axis = 0; axis < 3; ++axis)
        for (const auto& [p, q, sign] : {std::tuple(l.a, l.a, 1.0), std::tuple(l.b, l.b, 1.0),
                                         std::tuple(l.a, l.b, -1.0), std::tuple(l.b, l.a, -1.0)})
          h(3 * p + axis, 3 * q + axis) += sign * multipliers[j];
    }
    Eigen::Index row = links;
    for (int v = 0; cells && v + 1 < grid.nv; ++v)
      for (int u = 0; u + 1 < grid.nu; ++u)
        for (int axis = 0; axis < 3; ++axis, ++row)
          for (const auto& [vertex, sign] :
               {std::pair(grid.index(u, v), 1.0), std::pair(grid.index(u + 1, v), -1.0),
                std::pair(grid.index(u, v + 1), -1.0), std::pair(grid.index(u + 1, v + 1), 1.0)}) {
            jacobian(row, 3 * vertex + axis) = sign;
            c[row] += sign * x[to_index(vertex)][axis];
          }
    g += jacobian.transpose() * multipliers;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (w[i] == 0) {
        const auto at = 3 * static_cast<Eigen::Index>(i);
        h.middleRows<3>(at).setZero();
        h.middleCols<3>(at).setZero();
        h.diagonal().segment<3>(at).setOnes();
        g.segment<3>(at).setZero();
        jacobian.middleCols<3>(at).setZero();
      }
    Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + rows, n + rows);
    kkt << h, jacobian.transpose(), jacobian, Eigen::MatrixXd::Zero(rows, rows);
    Eigen::VectorXd right(n + rows);
    right << -g, -c;
    const Eigen::VectorXd step =
        Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(kkt).solve(right);
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] += step.segment<3>(3 * static_cast<Eigen::Index>(i));
    multipliers += step.tail(rows);
    if (step.head(n).norm() < 1e-13) return x;
  }
  ADD_FAILURE() << "did not converge";
  return x;
}

/// Sheets that fold along their rows, chains and nets, with random velocities.
TEST(Convergence, ExactStepOfRigidLinksAgreesWithDenseKkt) {
  Stiffness rigid;
  rigid.fill(std::numeric_limits<double>::infinity());
  for (const unsigned seed : {3u, 4u, 5u})
    for (auto [scene, cells] : {std::pair(let_go(5, 5, {true, true, false}), true),
                                std::pair(let_go(3, 6, {true, true, false}), true),
                                std::pair(let_go(4, 5, {true, false, false}), false),
                                std::pair(hanging_sheet(1, 12, {true, false, false}), false)}) {
      std::mt19937 random(seed);
      for (Vec3& v : scene.start.v)
        for (double& speed : v) speed = static_cast<double>(random()) / 4294967296.0 - 0.5;
      for (const int pin : scene.pins) scene.start.v[to_index(pin)].setZero();
      const reference::ImplicitStep step(scene, scene.start, 0, rigid);
      const auto exact = step.minimum(scene.start.x);
      ASSERT_EQ(exact.problem, "");
      EXPECT_LT(exact.stretch, 1e-11);
      EXPECT_LT(largest_distance(exact.x, nearest_placement(scene, step.prediction(), cells)), 1e-9)
          << seed << ' ' << scene.mesh.size();
    }
}

/// A sweep minimises over one vertex after another and so lowers the energy. The distance from the
/// exact step may grow at first, since stretch disappears before bending.
TEST(Convergence, VertexBlockDescentLowersTheGapInEverySweep) {
  const Scene scene = let_go(6, 6, {true, true, false});
  const State state = state_at(scene, parse_solver("implicit:structural=1e5,shear=1e5"), 0.5);
  for (const char* order : {"coloured", "mesh"}) {
    const Convergence vbd =
        converge(scene, state, 0.5, {std::string("vbd:order=") + order}, 1 << 11).front();
    double farthest = 0;
    for (std::size_t i = 1; i < vbd.points.size(); ++i) {
      EXPECT_LE(vbd.points[i].gap, vbd.points[i - 1].gap + 1e-12) << order;
      farthest = std::max(farthest, vbd.points[i].distance);
    }
    EXPECT_GT(farthest, 1.2 * vbd.points[0].distance) << order;
    EXPECT_LT(vbd.points.back().distance, 1e-9) << order;
  }
}

// All solvers step from the state to which the scene's own motion leads, as the pins show.
TEST(Convergence, BeginsWhereTheScenesOwnMotionHasBroughtIt) {
  Scene scene = let_go(4, 4, {true, true, false});
  PinMotion pins{{1}, {}};
  pins.motion.path = {{0, Vec3::Zero()}, {0.25, Vec3(0.02, 0, 0.01)}, {1, Vec3(0, 0.03, 0)}};
  scene.pin_motions = {pins};
  for (const double at : {0.0, 0.125, 0.5, 1.0}) {
    const State state = state_at(scene, parse_solver("jakobsen:precision=double"), at);
    for (const int pin : scene.pins)
      EXPECT_LT((state.x[to_index(pin)] - pin_position(scene, pin, at)).norm(), 1e-12) << at;
  }
}

/// Motion is along the chain: strains shrink as the sweep's matrix predicts.
TEST(Convergence, GaussSeidelAndJacobiContractAsPrinted) {
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
  scene.dt = 1.0 / 64;
  scene.steps = 1;
  scene.gravity = Vec3::Zero();
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

/// Projection along current directions depends on the order and misses the nearest placement.
TEST(Convergence, GaussSeidelOfRigidLinksEndsOnAFloor) {
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

/// The distance hardly falls, but the solver is still converging and not on a floor.
TEST(Convergence, AFrozenSolverIsOnNoFloor) {
  Scene scene = hanging_sheet(1, 6, {true, false, false});
  for (std::size_t i = 1; i < scene.start.v.size(); ++i) scene.start.v[i] = {3, 0, 0};
  const Convergence pd = of_one(scene, "pd:structural=1e9", 64);
  ASSERT_EQ(pd.problem, "");
  EXPECT_GT(pd.points.back().distance, 0.9 * pd.points[3].distance);
  EXPECT_GT(pd.contraction, 0.999);
  EXPECT_EQ(pd.floor, 0);
}

/// The last third of the distances hardly falls, as on a floor, but twice as many iterations still
/// move the cloth.
TEST(Convergence, ACreepingSolverIsOnNoFloor) {
  const Scene scene = load_scene(find_scene("swing"));
  const State state = state_at(scene, parse_solver("implicit:structural=1e5,shear=1e5"), 0.5);
  const Convergence pd = converge(scene, state, 0.5, {"pd:structural=1e4,shear=1e4"}, 64).front();
  ASSERT_EQ(pd.problem, "");
  EXPECT_GT(pd.points.back().distance, 0.9 * pd.points[8].distance);
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

TEST(Convergence, AGapIsReachedWhereItStaysBelow) {
  Convergence c;
  for (const double gap : {1.0, 0.01, 0.5, 0.02, 0.01}) c.points.push_back({.gap = gap});
  EXPECT_EQ(reached(c, 0.1), 3) << "it had risen again";
  EXPECT_EQ(reached(c, 1), 0);
  EXPECT_EQ(reached(c, 0.001), -1);
  c.points.push_back({.gap = std::nan("")});
  EXPECT_EQ(reached(c, 1), -1);
}

TEST(Convergence, SaysWhatItCannotCompare) {
  const Scene scene = hanging_sheet(1, 4, {true, false, false});
  EXPECT_FALSE(of_one(scene, "mass-spring", 4).refused.empty());
  Scene elastic = scene;
  const auto of = [&](const char* solver) {
    return stiffness_of(elastic, parse_solver(solver).params)[0];
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
