// Projective Dynamics and ADMM: the limit of their iterations and the rate of convergence.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/reference/dense.hpp"
#include "tests/solver/both_precisions.hpp"
#include "tests/solver/elastic_step.hpp"
#include "tests/support/cloths.hpp"

namespace taut::global_test {
namespace {

constexpr std::array kSoft{800.0, 300.0, 50.0};
const std::string kSoftText = "structural=800,shear=300,bend=50";

TEST(ProjectiveDynamics, FixedPointIsNewtonsStep) {
  for (const unsigned seed : {1u, 2u}) {
    const Scene scene = irregular_net(seed);
    const std::vector<Vec3> exact = ElasticStep(scene, kSoft).minimum();
    const State mine = after_one_step(scene, "pd:iterations=10000," + kSoftText);
    EXPECT_LT(largest_distance(mine.x, exact), 1e-8) << "seed " << seed;
    EXPECT_GT(largest_distance(after_one_step(scene, "pd:iterations=10," + kSoftText).x, exact),
              1e-6);
  }
}

TEST(ProjectiveDynamics, ByOtherMethodsItGoesToTheSamePoint) {
  for (const unsigned seed : {3u, 4u}) {
    const Scene scene = irregular_net(seed);
    const std::vector<Vec3> exact = ElasticStep(scene, kSoft).minimum();
    for (const char* method : {"lbfgs", "ncg", "ncg,preconditioner=factor"})
      EXPECT_LT(largest_distance(after_one_step(scene, "pd:iterations=2000,method=" +
                                                           std::string(method) + "," + kSoftText)
                                     .x,
                                 exact),
                1e-8)
          << method;
    // without correction pairs L-BFGS is Projective Dynamics
    EXPECT_LT(largest_distance(
                  after_one_step(scene, "pd:iterations=10,method=lbfgs,history=0," + kSoftText).x,
                  after_one_step(scene, "pd:iterations=10," + kSoftText).x),
              1e-13);
    // and with pairs it converges faster
    const auto error = [&](const std::string& more) {
      return largest_distance(after_one_step(scene, "pd:" + kSoftText + more).x, exact);
    };
    EXPECT_LT(error(",iterations=60,method=lbfgs"), 0.5 * error(",iterations=60"));
  }
}

TEST(ProjectiveDynamics, OtherMethodsSayWhatTheyDoNotKnow) {
  Scene scene = hanging_sheet(3, 3);
  scene.colliders = {{.shape = Plane{.offset = -3}}};
  for (const char* method : {"lbfgs", "ncg"}) {
    const SolverChoice choice = parse_solver("pd:chebyshev=0.9,method=" + std::string(method));
    EXPECT_EQ(choice.entry->unsupported(scene, choice.params).size(), 2u);
  }
}

TEST(ProjectiveDynamics, AcceleratedItGoesToTheSamePointFaster) {
  const Scene scene = irregular_net(3);
  const std::vector<Vec3> exact = ElasticStep(scene, kSoft).minimum();
  const auto error = [&](const std::string& more) {
    return largest_distance(after_one_step(scene, "pd:" + kSoftText + more).x, exact);
  };
  EXPECT_LT(error(",iterations=10000,chebyshev=0.9"), 1e-8);
  EXPECT_LT(error(",iterations=1000,anderson=5"), 1e-8);
  EXPECT_LT(error(",iterations=100,chebyshev=0.9"), 0.5 * error(",iterations=100"));
  EXPECT_LT(error(",iterations=100,anderson=5"), 0.5 * error(",iterations=100"));
}

/// Iteration k can combine k - 1 differences: a window of m first drops one in iteration m + 2.
TEST(ProjectiveDynamics, AndersonCombinesAsManyIterationsAsItIsTold) {
  const Scene scene = irregular_net(9);
  const auto after = [&](int window, int iterations) {
    return after_one_step(scene, "pd:anderson=" + std::to_string(window) +
                                     ",iterations=" + std::to_string(iterations))
        .x;
  };
  for (const int window : {1, 2, 3}) {
    EXPECT_EQ(after(window, window + 1), after(20, window + 1)) << window;
    EXPECT_NE(after(window, window + 2), after(window + 1, window + 2)) << window;
  }
}

TEST(ProjectiveDynamics, AStraightLoadedChainIsExactAfterOnePass) {
  Scene scene = hanging_sheet(1, 12, {true, false, false});
  for (std::size_t i = 1; i < scene.start.x.size(); ++i) scene.start.v[i] = {0, -0.3, 0};
  const ElasticStep step(scene, {500, 1, 1});
  const State mine = after_one_step(scene, "pd:iterations=1,structural=500");
  EXPECT_LT(largest_distance(mine.x, step.minimum()), 1e-12);
  EXPECT_GT(largest_distance(mine.x, step.y()), 1e-4);
}

/// A stretched chain between two pins, moved across its line in the mode of the Laplacian's
/// eigenvalue lambda.
TEST(ProjectiveDynamics, ContractsAcrossAStretchedChainAsItShould) {
  constexpr int kLinks = 9;
  constexpr double kStrain = 0.05, kMass = 0.01;
  for (const double stiffness : {10.0, 1e3, 1e5})
    for (const int mode : {1, 4}) {
      Scene scene;
      scene.dt = 1.0 / 64;
      scene.steps = 1;
      scene.gravity = Vec3::Zero();
      for (int i = 0; i <= kLinks; ++i) {
        const double shape = std::sin(std::numbers::pi * mode * i / kLinks);
        scene.start.x.emplace_back(0.1 * (1 + kStrain) * i, 0, 0);
        scene.start.v.emplace_back(0, 1e-5 * shape / scene.dt, 0);
        scene.mesh.mass.push_back(kMass);
        if (i > 0) scene.links.push_back({i - 1, i, 0.1, Family::structural});
      }
      scene.mesh.rest = scene.start.x;
      scene.pins = {0, kLinks};
      scene.start.v.back() = Vec3::Zero();
      const auto after = [&](int iterations) {
        return after_one_step(scene, "pd:iterations=" + std::to_string(iterations) +
                                         ",structural=" + std::to_string(stiffness))
            .x[2]
            .y();
      };
      const double lambda = 2 - 2 * std::cos(std::numbers::pi * mode / kLinks);
      const double s = scene.dt * scene.dt * stiffness / kMass, e = kStrain / (1 + kStrain);
      const double rate = s * lambda * (1 - e) / (1 + s * lambda);
      // differences of successive iterates shrink at the rate of their errors
      EXPECT_NEAR((after(3) - after(2)) / (after(2) - after(1)), rate, 0.01 * rate)
          << stiffness << " N/m, mode " << mode;
    }
}

TEST(Admm, FixedPointOfSpringsIsNewtonsStep) {
  const Scene scene = irregular_net(2);
  const std::vector<Vec3> exact = ElasticStep(scene, kSoft).minimum();
  for (const char* ratio : {"1", "1.5"}) {
    const State mine = after_one_step(
        scene, "admm:links=elastic,iterations=8000," + kSoftText + ",penalty-ratio=" + ratio);
    EXPECT_LT(largest_distance(mine.x, exact), 1e-8) << ratio;
  }
}

/// With rigid links the limit is the nearest placement, in the norm of the masses, that keeps all
/// lengths. There m (x - y) is a linear combination of the gradients of the lengths.
TEST(Admm, RigidLinksEndAtTheConstrainedMinimum) {
  Scene scene = hanging_sheet(1, 10, {true, false, false});
  for (std::size_t i = 1; i < scene.start.x.size(); ++i)
    scene.start.v[i] = {1.0 + static_cast<double>(i % 3), 0.5, -0.2 * static_cast<double>(i)};
  const State mine = after_one_step(scene, "admm:iterations=5000,penalty=300");
  const ElasticStep step(scene, {1, 1, 1});
  const auto links = static_cast<Eigen::Index>(scene.links.size());
  Eigen::MatrixXd gradients = Eigen::MatrixXd::Zero(3 * links, links);
  Eigen::VectorXd pull(3 * links);
  for (Eigen::Index j = 0; j < links; ++j) {  // link j ends at vertex j + 1
    const auto i = static_cast<std::size_t>(j);
    EXPECT_LT(std::abs(step.stretch(mine.x, i)), 1e-10);
    const Vec3 u = (mine.x[i + 1] - mine.x[i]).normalized();
    gradients.block<3, 1>(3 * j, j) = u;
    if (j > 0) gradients.block<3, 1>(3 * (j - 1), j) = -u;
    pull.segment<3>(3 * j) = scene.mesh.mass[i + 1] * (mine.x[i + 1] - step.y()[i + 1]);
  }
  const Eigen::VectorXd multipliers =
      reference::solve(gradients.transpose() * gradients, gradients.transpose() * pull);
  EXPECT_LT((pull - gradients * multipliers).norm(), 1e-9 * pull.norm());
  EXPECT_GT(pull.norm(), 1e-4);
}

/// The first step of both solvers, written out: factor, links, factor.
TEST(Admm, AgreesWithADenseProgramOnAnIrregularMesh) {
  const Scene scene = irregular_net(7);
  const ElasticStep step(scene, {1, 1, 1});
  const std::vector<double> w = inverse_masses(scene);
  const auto n = static_cast<Eigen::Index>(w.size());
  const double k = 150;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    matrix(i, i) = w[static_cast<std::size_t>(i)] > 0
                       ? 1 / (w[static_cast<std::size_t>(i)] * scene.dt * scene.dt)
                       : 1;
  const Eigen::VectorXd inertia = matrix.diagonal();
  for (const Link& l : scene.links)
    for (const auto& [i, other] : {std::pair(l.a, l.b), std::pair(l.b, l.a)})
      if (w[to_index(i)] > 0) {
        matrix(i, i) += k;
        matrix(i, other) -= k;
      }
  std::vector<Vec3> x = step.y(), u(scene.links.size(), Vec3::Zero());
  for (int iteration = 0; iteration < 7; ++iteration) {
    Eigen::MatrixXd right(n, 3);
    for (Eigen::Index i = 0; i < n; ++i)
      right.row(i) = inertia[i] * step.y()[static_cast<std::size_t>(i)];
    for (std::size_t j = 0; j < u.size(); ++j) {
      const Link& l = scene.links[j];
      const Vec3 p = x[to_index(l.b)] - x[to_index(l.a)] + u[j];
      const Vec3 z = l.rest * p.normalized();
      u[j] = p - z;
      if (w[to_index(l.a)] > 0) right.row(l.a) -= k * (z - u[j]);
      if (w[to_index(l.b)] > 0) right.row(l.b) += k * (z - u[j]);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::VectorXd column = reference::solve(matrix, right.col(axis));
      for (std::size_t i = 0; i < x.size(); ++i) x[i][axis] = column[static_cast<Eigen::Index>(i)];
    }
  }
  EXPECT_LT(largest_distance(after_one_step(scene, "admm:iterations=7,penalty=150").x, x), 1e-9);
}

TEST(GlobalSolvers, SayThatFrictionIsPartOfTheSolve) {
  Scene scene = hanging_sheet(6, 6);
  scene.pins.clear();
  scene.colliders = {{.shape = Plane{{0, 1, 0}, -1.2}}};
  for (const char* solver : {"implicit:iterations=8", "pd", "admm", "vbd", "avbd"}) {
    const auto says = [&](const std::string& text, const char* part) {
      const SolverChoice choice = parse_solver(text);
      const ResolvedSettings lines = choice.entry->resolved_settings(scene, choice.params);
      return std::ranges::any_of(lines, [&](const ResolvedSetting& line) {
        return line.name == "friction" && line.text.find(part) != std::string::npos;
      });
    };
    EXPECT_TRUE(says(solver, "forces of the solve")) << solver;
    EXPECT_TRUE(says(with(solver, "contact=after"), "times the depth")) << solver;
    for (const Vec3& x : simulate(scene, solver, 40).x) EXPECT_GE(x.y(), -1.2 - 1e-12) << solver;
  }
}

TEST(GlobalSolvers, RefuseTwoAccelerationsAtOnce) {
  const SolverChoice both = parse_solver("pd:chebyshev=0.9,anderson=5");
  EXPECT_EQ(both.entry->unsupported(hanging_sheet(3, 3), both.params).size(), 1u);
  EXPECT_TRUE(both.entry->unsupported(hanging_sheet(3, 3), parse_solver("pd").params).empty());
}

TEST(GlobalSolvers, StepCostCountsTheFactor) {
  const Scene scene = hanging_sheet(8, 8);
  for (const char* solver : {"implicit", "pd", "admm"}) {
    const SolverChoice choice = parse_solver(solver);
    const auto costs = choice.entry->make(scene, choice.params)->step_cost();
    const auto& factor = costs.back();
    EXPECT_GT(factor.items, 62u) << solver;  // more than the diagonal of the moving vertices
    EXPECT_GE(factor.bytes, 12 * factor.items) << solver;
    EXPECT_EQ(projections_per_step(*choice.entry->make(scene, choice.params)), 0u) << solver;
  }
}

/// Links are internal forces and must not change the fall of the centre of mass. Solvers that solve
/// for all vertices at once satisfy this after any number of iterations. vbd does so only once it
/// has converged, as it moves vertex after vertex against its own inertia.
TEST(GlobalSolvers, KeepTheFallOfTheCentreOfMass) {
  Scene scene = hanging_sheet(6, 5, {true, true, false});
  scene.pins.clear();
  for (Vec3& x : scene.start.x) x *= 1.02;
  const auto fall = [&](const std::string& solver) {
    const State end = simulate(scene, solver, 64);
    double way = 0, mass = 0;
    for (std::size_t i = 0; i < end.x.size(); ++i) {
      way += scene.mesh.mass[i] * (scene.start.x[i] - end.x[i]).y();
      mass += scene.mesh.mass[i];
    }
    return way / mass / (9.81 / 2 * (1 + 1.0 / 64));  // distance that the steps sum up to
  };
  for (const char* solver : {"implicit:iterations=3", "pd:iterations=2", "admm:iterations=2"})
    EXPECT_NEAR(fall(solver), 1, 1e-9) << solver;
  EXPECT_LT(fall("vbd:iterations=10"), 0.9);
  EXPECT_NEAR(fall("vbd:iterations=4000"), 1, 1e-3);
}

/// The factor and its right-hand sides are in double; positions and forces of links are in float.
TEST(GlobalSystems, FloatFollowsDouble) {
  for (const char* solver : {"pd:iterations=20", "admm:iterations=20"})
    expect_float_follows_double(solver);
}

/// With springs this stiff a factor in float would lose the masses; the cloth has to fall all the
/// same.
TEST(GlobalSystems, InFloatStiffLinksDoNotHoldUpAFall) {
  Scene scene = hanging_sheet(9, 8);
  scene.pins.clear();
  for (const char* solver : {"pd:iterations=10,structural=1e8,shear=1e8,precision=float",
                             "admm:iterations=10,penalty=1e8,precision=float"}) {
    const State end = simulate(scene, solver, 16);
    double fall = 0;
    for (std::size_t i = 0; i < end.v.size(); ++i)
      fall += end.v[i].y() / static_cast<double>(end.v.size());
    EXPECT_NEAR(fall, scene.gravity.y() * 16 * scene.dt, 1e-3) << solver;
  }
}

TEST(GlobalSystems, ALinkOfNoLengthHasNoDirection) {
  for (const char* solver : {"pd:iterations=1", "admm:iterations=1", "mass-spring:substeps=1"})
    expect_link_of_no_length_is_harmless(solver);
}

}  // namespace
}  // namespace taut::global_test
