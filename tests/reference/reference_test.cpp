// The reference solvers against closed forms, and their refusal to answer where there is no answer.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/reference/closed_forms.hpp"
#include "core/reference/relaxation.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/static_equilibrium.hpp"

namespace taut::reference {
namespace {

constexpr double kG = 9.81;

/// A sheet whose two upper corners are `span` apart; structural links only, unless said.
Scene two_corners(int n, double span, const LinkChoice& choice = {}) {
  Scene s;
  s.mesh = make_sheet({.nu = n, .nv = n, .width = 1, .height = 1, .mass = 0.2});
  s.start = {s.mesh.rest, std::vector<Vec3>(s.mesh.rest.size(), Vec3::Zero())};
  s.pins = {0, n - 1};
  s.start.x[static_cast<std::size_t>(n - 1)].x() = span;
  s.links = grid_links(s.mesh, choice);
  s.dt = 1.0 / 64;
  return s;
}

Scene rods(int n, const std::vector<Vec3>& x) {
  Scene s;
  s.mesh = make_sheet({.nu = 1,
                       .nv = n + 1,
                       .height = static_cast<double>(n),
                       .mass = n + 1.0,
                       .lumping = Lumping::equal});
  s.start = {x, std::vector<Vec3>(x.size(), Vec3::Zero())};
  s.pins = {0};
  s.links = grid_links(s.mesh, {});
  s.dt = 1.0 / 64;
  return s;
}

TEST(ClosedForms, PendulumPeriodsAreThoseOfTheTables) {
  const auto period = [](double degrees) {
    return pendulum_period(1, kG, degrees * std::numbers::pi / 180);
  };
  EXPECT_NEAR(period(10), 2.009892627, 5e-10);
  EXPECT_NEAR(period(90), 2.367841948, 5e-10);
  EXPECT_NEAR(period(170), 4.893524274, 5e-10);
}

TEST(ClosedForms, HangingChainFrequenciesTendToBessels) {
  const auto w16 = hanging_chain_frequencies(16, 1, kG), w32 = hanging_chain_frequencies(32, 1, kG);
  EXPECT_NEAR(w16[0], 3.70910, 5e-6);
  EXPECT_NEAR(w16[1], 8.52202, 5e-6);
  EXPECT_NEAR(w32[0], 3.73712, 5e-6);
  EXPECT_NEAR(w32[1], 8.58035, 5e-6);
  EXPECT_NEAR(hanging_rope_frequency(1, 1, kG), 3.76607, 5e-6);
  EXPECT_NEAR(hanging_rope_frequency(2, 1, kG), 8.64470, 5e-6);
}

TEST(ClosedForms, SpringGridEigenvaluesAndStepLimits) {
  EXPECT_NEAR(spring_grid_eigenvalue(20, false, false), 3.975, 5e-4);
  EXPECT_NEAR(spring_grid_eigenvalue(20, true, false), 7.927, 5e-4);
  EXPECT_NEAR(spring_grid_eigenvalue(20, true, true), 9.987, 5e-4);
}

TEST(ClosedForms, CatenaryOfSixteenLinks) {
  const Catenary c = discrete_catenary(16, 0.8, 1.0 / 16, 1);
  EXPECT_NEAR(c.sag(), 0.265991492135, 5e-13);
  EXPECT_NEAR(c.x.back(), 0.8, 1e-14);
  EXPECT_NEAR(c.y.back(), 0.0, 1e-14);
  EXPECT_NEAR(continuum_sag(1, 0.8), 0.265437509140, 5e-13);
}

TEST(ClosedForms, OneSweepLeavesEveryLinkTheWeightBelowIt) {
  const int n = 16;
  const Eigen::VectorXd e = steady_strain(chain_sweep(n, Sweep::gauss_seidel), 1, 1);
  for (int j = 0; j < n; ++j) EXPECT_NEAR(e[j], n - 1 - j, 1e-9);
}

TEST(StaticEquilibrium, ASheetOnTwoCornersIsACatenaryWithStraightColumns) {
  for (const int n : {6, 12}) {
    const Scene s = two_corners(n, 0.8);
    const Equilibrium e = static_equilibrium(s);
    ASSERT_TRUE(e.unique) << e.reason;
    double column = 0;
    for (int j = 0; j < n; ++j)
      column += s.mesh.mass[static_cast<std::size_t>(s.mesh.grid->index(1, j))];
    const double l = 1.0 / (n - 1);
    const Catenary top = discrete_catenary(n - 1, 0.8, l, column * kG);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const Vec3 expected(top.x[at], top.y[at] - j * l, 0);
        EXPECT_LT((e.x[static_cast<std::size_t>(s.mesh.grid->index(i, j))] - expected).norm(),
                  1e-13);
      }
    EXPECT_LT(e.floor, 1e-13);
    EXPECT_LT(e.violation, 1e-15);
    EXPECT_NEAR(e.tension[0], top.tension[0], 1e-12 * top.tension[0]);
  }
}

TEST(StaticEquilibrium, AFlatSheetOneWidthApartNeedsNoIteration) {
  const Scene s = two_corners(8, 1, {.shear = true});
  const Equilibrium e = static_equilibrium(s);
  ASSERT_TRUE(e.unique) << e.reason;
  for (std::size_t i = 0; i < e.x.size(); ++i) EXPECT_LT((e.x[i] - s.mesh.rest[i]).norm(), 1e-14);
}

TEST(StaticEquilibrium, RefusesWhatHasNoUniqueAnswer) {
  EXPECT_FALSE(static_equilibrium(two_corners(6, 0.8, {.shear = true})).unique);  // locks
  EXPECT_FALSE(static_equilibrium(two_corners(6, 0.8, {.bend = true})).unique);
  EXPECT_FALSE(static_equilibrium(two_corners(6, 1.2)).unique);  // the pins are too far apart
  Scene ball = two_corners(6, 0.8);
  ball.colliders.push_back({Ball{Vec3(0.5, -0.5, 0), 0.2}, {}, 0});
  EXPECT_NE(static_equilibrium(ball).reason.find("contact"), std::string::npos);
  Scene free = two_corners(6, 0.8);
  free.pins.clear();
  EXPECT_FALSE(static_equilibrium(free).unique);
}

TEST(Shake, DoublePendulumConvergesInSecondOrder) {
  const double a = 120 * std::numbers::pi / 180, b = -10 * std::numbers::pi / 180;
  const auto exact = double_pendulum({a, b}, 1);
  EXPECT_LT((exact[0] - Vec3(-0.9986224057, -0.0524718108, 0)).norm(), 1e-10);
  EXPECT_LT((exact[1] - Vec3(-0.7505341127, -1.0212092359, 0)).norm(), 1e-10);
  const Vec3 x1(std::sin(a), -std::cos(a), 0);
  const Scene s = rods(2, {Vec3::Zero(), x1, x1 + Vec3(std::sin(b), -std::cos(b), 0)});
  double error[2];
  for (const int r : {0, 1}) {
    Shake shake(s, 1.0 / (256 << r));
    for (int n = 0; n < 256 << r; ++n) ASSERT_TRUE(shake.step());
    error[r] = (shake.state().x[2] - exact[1]).norm();
  }
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.02);
  const Trajectory t = converged_motion(s, {1}, 1.0 / 256);
  ASSERT_TRUE(t.unique) << t.reason;
  EXPECT_LT((t.states[0].x[2] - exact[1]).norm(), 2 * t.floor[0]);
}

TEST(Shake, RefusesContactAndLockingLinks) {
  EXPECT_FALSE(converged_motion(two_corners(4, 1, {.shear = true}), {0.1}, 1e-3).unique);
  Scene s = two_corners(4, 0.8);
  EXPECT_FALSE(converged_motion(s, {0.1}, 1e-3).unique);  // stretched start
}

}  // namespace
}  // namespace taut::reference
