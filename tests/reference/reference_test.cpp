// The reference solvers against closed forms, and their refusal of problems without an answer.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "core/model/bending.hpp"
#include "core/reference/closed_forms.hpp"
#include "core/reference/shake.hpp"
#include "core/reference/static_equilibrium.hpp"

namespace taut::reference::reference_test {
namespace {

constexpr double kG = 9.81;

/// Sheet whose two upper corners are `span` apart; by default with structural links only.
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

/// One link swings as in implicit Euler for any number of sweeps: y = l/(l + g dt^2) y.
TEST(ClosedForms, TransverseSweepsOfOneLinkAreImplicitEuler) {
  for (const int sweeps : {1, 3})
    EXPECT_NEAR(transverse_sweeps(1, sweeps, 0.01, 0.5)(0, 0), 0.5 / 0.51, 1e-15);
}

TEST(ClosedForms, OneSweepLeavesEveryLinkTheWeightBelowIt) {
  const int n = 16;
  const Eigen::VectorXd e = steady_strain(chain_sweep(n, Sweep::gauss_seidel), 1, 1);
  for (int j = 0; j < n; ++j) EXPECT_NEAR(e[j], n - 1 - j, 1e-9);
}

TEST(StaticEquilibrium, ASheetOnTwoCornersIsACatenary) {
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

/// Two rows of vertices on two corners; masses differ by up to four orders of magnitude.
Scene uneven_net(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const int n = 4 + static_cast<int>(random() % 5);
  Scene s;
  s.mesh = make_sheet({.nu = n, .nv = 2, .width = 1, .height = 1, .mass = 0.2});
  s.start = {s.mesh.rest, std::vector<Vec3>(s.mesh.rest.size(), Vec3::Zero())};
  s.pins = {0, n - 1};
  s.start.x[static_cast<std::size_t>(n - 1)].x() = 0.3 + 0.6 * uniform();
  for (double& mass : s.mesh.mass) mass *= std::pow(10.0, 4 * uniform() - 2);
  s.links = grid_links(s.mesh, {});
  s.dt = 1.0 / 64;
  return s;
}

// The last four nets have no answer: Newton's method ends up to 4e-6 m from the links' lengths, or
// at two places as far as 4 cm apart.
TEST(StaticEquilibrium, IsFoundOfNetsWithUnevenMassesOrNotAtAll) {
  int found = 0;
  for (const unsigned seed : {0u, 1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u, 9u, 391u, 508u, 1415u, 1698u}) {
    const Equilibrium e = static_equilibrium(uneven_net(seed));
    EXPECT_NE(e.unique, e.reason != "") << seed;
    if (!e.unique) continue;
    EXPECT_LT(e.violation, 1e-12) << seed;
    EXPECT_LT(e.floor, 1e-12) << seed;
    EXPECT_LT(e.unbalanced, 1e-12) << seed;
    ++found;
  }
  EXPECT_GE(found, 5);
  for (const unsigned seed : {391u, 508u, 1415u, 1698u})
    EXPECT_FALSE(static_equilibrium(uneven_net(seed)).unique) << seed;
}

TEST(StaticEquilibrium, RefusesWhatHasNoUniqueAnswer) {
  const auto reason = [](const Scene& scene) {
    const Equilibrium e = static_equilibrium(scene);
    EXPECT_FALSE(e.unique);
    return e.reason;
  };
  const std::string push = " would have to push: the sheet folds or locks, in more than one way";
  EXPECT_TRUE(reason(two_corners(6, 0.8, {.shear = true})).ends_with(push));
  EXPECT_TRUE(reason(two_corners(6, 0.8, {.bend = true})).starts_with("bending links push"));
  Scene soft = rods(2, {Vec3::Zero(), Vec3(0, -1, 0), Vec3(0, -2, 0)});
  soft.stiffness.fill(100);
  EXPECT_TRUE(reason(soft).starts_with("links are elastic"));
  EXPECT_FALSE(reason(two_corners(6, 1.2)).ends_with(push)) << "the pins are too far apart";
  for (const double too_far : {1e-3, 1e-6, 1e-8})
    EXPECT_EQ(reason(two_corners(6, 1 + too_far)), "the KKT system is singular") << too_far;
  Scene ball = two_corners(6, 0.8);
  ball.colliders.push_back({Ball{Vec3(0.5, -0.5, 0), 0.2}, {}, 0});
  EXPECT_NE(static_equilibrium(ball).reason.find("contact"), std::string::npos);
  Scene free = two_corners(6, 0.8);
  free.pins.clear();
  EXPECT_FALSE(static_equilibrium(free).unique);
}

/// Expects that tensions and weights cancel at every free vertex, that links under tension have
/// their rest length, and that other links are shorter.
void expect_balance(const Scene& s, const Equilibrium& e) {
  ASSERT_TRUE(e.unique) << e.reason;
  ASSERT_EQ(e.tension.size(), s.links.size());
  std::vector<Vec3> force;
  for (const double mass : s.mesh.mass) force.push_back(mass * s.gravity);
  for (std::size_t j = 0; j < s.links.size(); ++j) {
    const auto a = static_cast<std::size_t>(s.links[j].a),
               b = static_cast<std::size_t>(s.links[j].b);
    const Vec3 along = e.x[b] - e.x[a];
    EXPECT_NEAR(along.norm(), s.links[j].rest, 1e-12) << j;
    EXPECT_GE(e.tension[j], 0) << j;
    force[a] += e.tension[j] * along.normalized();
    force[b] -= e.tension[j] * along.normalized();
  }
  for (std::size_t i = 0; i < force.size(); ++i)
    if (std::ranges::count(s.pins, static_cast<int>(i)))
      EXPECT_EQ((e.x[i] - s.start.x[i]).norm(), 0) << i;
    else
      EXPECT_LT(force[i].norm(), 1e-11) << i;
  EXPECT_LT(e.floor, 1e-12);
  EXPECT_GT(e.floor, 0) << "two ways that share nothing never agree to the last bit";
  EXPECT_LT(e.violation, 1e-12);
  EXPECT_LT(e.unbalanced, 1e-11);
}

TEST(StaticEquilibrium, OfAnUnevenNetBalancesAtEveryVertex) {
  Scene rope = rods(9, std::vector<Vec3>(10, Vec3::Zero()));
  for (std::size_t i = 0; i < 10; ++i) {
    rope.mesh.mass[i] = 0.1 + 0.05 * static_cast<double>(i * 7 % 10);
    rope.start.x[i] = Vec3(0.6 * static_cast<double>(i), 0.1 * static_cast<double>(i % 3),
                           0.2 * static_cast<double>(i));
  }
  for (Link& l : rope.links) l.rest = 0.8 + 0.03 * (l.a * 5 % 9);
  rope.pins = {0, 9};
  rope.gravity = {0.3, -9, 1};
  expect_balance(rope, static_equilibrium(rope));
  Scene net = two_corners(5, 0.8);  // each column weighs differently from the next one
  for (std::size_t i = 0; i < net.mesh.mass.size(); ++i)
    net.mesh.mass[i] *= 1 + 0.1 * static_cast<double>(i % 5);
  expect_balance(net, static_equilibrium(net));
}

// Every link can have exactly its rest length: in a plumb line below a pin, and in a straight line
// between two pins at just that distance.
TEST(StaticEquilibrium, OfAPlumbLineIsKnownWithoutIteration) {
  Scene line = rods(5, {{0, 0, 0}, {1, 0, 0}, {1, 0.5, 0}, {2, 0, 0}, {2, 0, 1}, {3, 0, 1}});
  double depth = 0;
  for (Link& l : line.links) l.rest = 0.5 + 0.1 * l.a;
  line.gravity = {0, -3, 4};
  const Equilibrium hung = static_equilibrium(line);
  ASSERT_TRUE(hung.unique) << hung.reason;
  for (std::size_t i = 1; i < 6; ++i) {
    depth += line.links[i - 1].rest;
    EXPECT_LT((hung.x[i] - depth * Vec3(0, -0.6, 0.8)).norm(), 1e-14) << i;
  }
  EXPECT_LT(hung.floor, 1e-14);
  line.pins = {0, 4};  // the last vertex hangs below the second pin
  line.start.x[4] = Vec3(2, 1, 2).normalized() * (0.5 + 0.6 + 0.7 + 0.8);
  const Equilibrium taut = static_equilibrium(line);
  ASSERT_TRUE(taut.unique) << taut.reason;
  for (std::size_t i = 1; i < 4; ++i)
    EXPECT_NEAR((taut.x[i] - taut.x[i - 1]).norm(), line.links[i - 1].rest, 1e-12);
  EXPECT_LT((taut.x[2] - Vec3(2, 1, 2).normalized() * 1.1).norm(), 1e-12);
  EXPECT_LT((taut.x[5] - taut.x[4] - 0.9 * Vec3(0, -0.6, 0.8)).norm(), 1e-12);
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

/// Largest error of position and of velocity over all vertices during half a second.
template <class Exact>
std::array<double, 2> errors(const Scene& s, int steps, const Exact& exact) {
  Shake shake(s, 0.5 / steps);
  std::array<double, 2> most{};
  for (int n = 1; n <= steps; ++n) {
    EXPECT_TRUE(shake.step());
    EXPECT_NEAR(shake.time(), 0.5 * n / steps, 1e-12);
    const State is = shake.state(), should = exact(shake.time());
    for (std::size_t i = 0; i < is.x.size(); ++i) {
      most[0] = std::max(most[0], (is.x[i] - should.x[i]).norm());
      most[1] = std::max(most[1], (is.v[i] - should.v[i]).norm());
    }
  }
  return most;
}

template <class Exact>
void expect_second_order(const Scene& s, const Exact& exact) {
  const auto coarse = errors(s, 128, exact), fine = errors(s, 256, exact);
  for (const std::size_t k : {0u, 1u}) {
    EXPECT_NEAR(std::log2(coarse[k] / fine[k]), 2, 0.06) << k;
    EXPECT_LT(fine[k], 2e-3) << k;
  }
}

// A level sheet falls as one body: v' = g - (damping + c A/m) v + c A/m wind. Each vertex has the
// same share of A as of m.
TEST(Shake, DampingAndWindAreThoseOfAFallingSheet) {
  for (const double strength : {0.0, 0.9}) {
    Scene s;
    s.mesh =
        make_sheet({.nu = 4, .nv = 4, .width = 1, .height = 1, .v = Vec3::UnitZ(), .mass = 0.2});
    s.mesh.mass.assign(16, 0);
    for (const Triangle& t : s.mesh.triangles)  // a third for each corner, as for wind
      for (const int corner : t) s.mesh.mass[static_cast<std::size_t>(corner)] += 0.2 / 54;
    s.start = {s.mesh.rest, std::vector<Vec3>(16, Vec3(0.7, 2, -0.4))};
    s.links = grid_links(s.mesh, {});
    s.damping = 1.5;
    s.wind = Wind{.velocity = {5, 1.2, 3},
                  .strength = strength};  // a level face responds to vertical wind alone
    const double drag = strength / 0.2;
    expect_second_order(s, [&](double t) {
      State exact = s.start;
      for (std::size_t i = 0; i < 16; ++i) {
        for (const int axis : {0, 1, 2}) {
          const double rate = s.damping + (axis == 1 ? drag : 0),
                       push = axis == 1 ? drag * 1.2 - 9.81 : 0;
          const double end = push / rate, start = s.start.v[i][axis];
          exact.v[i][axis] = end + (start - end) * std::exp(-rate * t);
          exact.x[i][axis] += end * t + (start - end) * -std::expm1(-rate * t) / rate;
        }
      }
      return exact;
    });
  }
}

// Below a pin in uniform motion a pendulum swings as below a pin at rest, seen from the pin.
TEST(Shake, APinThatMovesEvenlyMovesThePendulumWithIt) {
  Scene rest = rods(2, {Vec3::Zero(), Vec3(0.6, -0.8, 0), Vec3(0.6, -0.8, 1)}), moving = rest;
  const Vec3 velocity(1, 0.5, -2);
  moving.pin_motions = {{{0}, {.velocity = velocity}}};
  for (Vec3& v : moving.start.v) v = velocity;
  Shake a(rest, 1.0 / 512), b(moving, 1.0 / 512);
  for (int n = 1; n <= 256; ++n) {
    ASSERT_TRUE(a.step() && b.step());
    const State resting = a.state(), carried = b.state();
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LT((carried.x[i] - resting.x[i] - n / 512.0 * velocity).norm(), 1e-10);
      EXPECT_LT((carried.v[i] - resting.v[i] - velocity).norm(), 1e-7);
    }
  }
}

// Half a period, in the plane and out of it, and the converged motion at several moments.
TEST(Shake, ConvergedMotionIsThatOfThePendulum) {
  const double a = 1.1, b = 0.4;
  const Vec3 x1(std::sin(a), -std::cos(a), 0);
  const Scene s = rods(2, {Vec3::Zero(), x1, x1 + Vec3(std::sin(b), -std::cos(b), 0)});
  const std::vector<double> times{0.25, 0.5, 0.75};
  const Trajectory t = converged_motion(s, times, 1.0 / 256);
  ASSERT_TRUE(t.unique) << t.reason;
  ASSERT_EQ(t.states.size(), 3u);
  ASSERT_EQ(t.floor.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto exact = double_pendulum({a, b}, times[k]),
               before = double_pendulum({a, b}, times[k] - 1e-4),
               after = double_pendulum({a, b}, times[k] + 1e-4);
    double worst = 0;
    for (const std::size_t i : {0u, 1u}) {
      worst = std::max(worst, (t.states[k].x[i + 1] - exact[i]).norm());
      EXPECT_LT((t.states[k].v[i + 1] - (after[i] - before[i]) / 2e-4).norm(), 1e-5) << k;
    }
    EXPECT_LT(worst, 1e-7) << k;
    EXPECT_LT(worst, 2 * t.floor[k]) << k;
    EXPECT_LT(t.floor[k], 1e-5) << k;
  }
}

/// Straight chain of n links of stiffness k [N/m] at their rest lengths, with masses of 1 kg.
Scene elastic_chain(int n, double k) {
  std::vector<Vec3> x;
  for (int i = 0; i <= n; ++i) x.emplace_back(0, -i, 0);
  Scene s = rods(n, x);
  s.stiffness.fill(k);
  return s;
}

// The chain stays straight, so that its springs are linear: u(t) = rest - sum of a_p phi_p cos w_p
// t with phi_p(j) = sin(j theta_p), theta_p = (2p - 1) pi/(2n + 1), w_p = 2 sqrt(k/m)
// sin(theta_p/2).
TEST(Shake, AnElasticChainLetGoVibratesInItsModes) {
  for (const int n : {1, 2, 7}) {
    const double k = 900;
    const Scene s = elastic_chain(n, k);
    const std::vector<double> times{0.25, 0.5, 1};
    const Trajectory t = converged_motion(s, times, 1.0 / 64);
    ASSERT_TRUE(t.unique) << t.reason;
    EXPECT_LE(t.dt * fastest_vibration(s), 0.5);
    for (std::size_t at = 0; at < times.size(); ++at)
      for (int j = 1; j <= n; ++j) {
        double sag = kG / k * (j * n - j * (j - 1) / 2);  // m g/k (n + (n - 1) + ...)
        for (int p = 1; p <= n; ++p) {
          const double theta = (2 * p - 1) * std::numbers::pi / (2 * n + 1);
          double amplitude = 0;
          for (int i = 1; i <= n; ++i)
            amplitude += kG / k * (i * n - i * (i - 1) / 2) * std::sin(i * theta);
          sag -= amplitude / ((2 * n + 1) / 4.0) * std::sin(j * theta) *
                 std::cos(2 * std::sqrt(k) * std::sin(theta / 2) * times[at]);
        }
        EXPECT_NEAR(t.states[at].x[static_cast<std::size_t>(j)].y(), -j - sag,
                    2 * t.floor[at] + 1e-12)
            << n << " links";
      }
    EXPECT_LT(t.floor.back(), 1e-4 * n);
  }
}

// Without links bending is linear: free modes of M^-1 K, where K comes from the bending elements.
TEST(Shake, BendingVibratesInTheModesOfItsEnergy) {
  Scene s = two_corners(5, 1);
  s.links.clear();
  s.pins.clear();
  s.gravity.setZero();
  s.bending = Bending{.warp = 2e-3, .weft = 1e-3};
  for (std::size_t i = 0; i < s.start.x.size(); ++i)
    s.start.x[i].z() += 0.01 * static_cast<double>(i * i % 7);
  const auto n = static_cast<Eigen::Index>(s.start.x.size());
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd root(n), z(n);
  for (const BendingElement& e : make_bending(s))
    for (std::size_t i = 0; i < e.size; ++i)
      for (std::size_t j = 0; j < e.size; ++j)
        k(e.vertex[i], e.vertex[j]) += e.stiffness * e.weight[i] * e.weight[j];
  for (Eigen::Index i = 0; i < n; ++i) {
    root[i] = std::sqrt(s.mesh.mass[static_cast<std::size_t>(i)]);
    z[i] = root[i] * s.start.x[static_cast<std::size_t>(i)].z();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(root.cwiseInverse().asDiagonal() * k *
                                                             root.cwiseInverse().asDiagonal());
  Eigen::VectorXd parts = modes.eigenvectors().transpose() * z;
  const double time = 0.5;
  for (Eigen::Index p = 0; p < n; ++p)
    parts[p] *= std::cos(std::sqrt(std::max(0.0, modes.eigenvalues()[p])) * time);
  EXPECT_GE(fastest_vibration(s), std::sqrt(modes.eigenvalues().maxCoeff()));
  const Eigen::VectorXd exact = modes.eigenvectors() * parts;
  const Trajectory t = converged_motion(s, {time}, 1.0 / 1024);
  ASSERT_TRUE(t.unique) << t.reason;
  EXPECT_LT(t.floor[0], 1e-6);
  for (Eigen::Index i = 0; i < n; ++i)
    EXPECT_NEAR(t.states[0].x[static_cast<std::size_t>(i)].z(), exact[i] / root[i],
                2 * t.floor[0] + 1e-12);
}

// Rods below springs test both kinds of link at once; the energy of springs and weights is
// conserved.
TEST(Shake, RodsBetweenSpringsKeepLengthsAndEnergy) {
  Scene s = elastic_chain(4, 500);
  s.stiffness[static_cast<std::size_t>(Family::shear)] = kRigid[0];
  s.links[1].family = s.links[3].family = Family::shear;
  s.start.v.assign(5, Vec3::Zero());
  s.start.v[4] = {1, 0, 2};
  EXPECT_FALSE(converged_motion(s, {0.5}, 1e-3).unique) << "rigid shear";
  s.stiffness = {kRigid[0], 500, 500};
  s.links[1].family = s.links[3].family = Family::structural;
  s.links[0].family = s.links[2].family = Family::shear;
  const auto energy = [&](const State& state) {
    double sum = 0;
    for (std::size_t i = 0; i < 5; ++i)
      sum += s.mesh.mass[i] * (state.v[i].squaredNorm() / 2 - state.x[i].dot(s.gravity));
    for (const std::size_t j : {0u, 2u})
      sum += 250 * std::pow((state.x[j + 1] - state.x[j]).norm() - 1, 2);
    return sum;
  };
  const Trajectory t = converged_motion(s, {0.5, 1}, 1.0 / 1024);
  ASSERT_TRUE(t.unique) << t.reason;
  for (const State& state : t.states) {
    for (const std::size_t j : {1u, 3u})
      EXPECT_NEAR((state.x[j + 1] - state.x[j]).norm(), 1, 2 * t.floor.back());
    EXPECT_NEAR(energy(state), energy(s.start), 1e-5);
  }
}

/// Sheet with shear links that hangs by its first row, turned by 0.7 rad from the vertical.
Scene rows_let_go(const LinkChoice& choice) {
  Scene s = two_corners(4, 1, choice);
  s.pins = {0, 1, 2, 3};
  for (std::size_t i = 0; i < 16; ++i) {
    const double depth = -s.mesh.rest[i].y();
    s.start.x[i] = Vec3(s.mesh.rest[i].x(), -std::cos(0.7) * depth, std::sin(0.7) * depth);
    s.mesh.mass[i] = 0.01 + 0.02 * static_cast<double>(i / 4);
  }
  return s;
}

// If rows stay straight, the sheet swings like the columns of a net without shear links, whose
// motion SHAKE computes with all links. The distribution of mass within a row does not matter.
TEST(Shake, RowsThatStayStraightSwingAsTheColumnsOfANet) {
  Scene sheet = rows_let_go({.shear = true});
  const Scene net = rows_let_go({});
  for (std::size_t i = 0; i < 16; ++i) sheet.mesh.mass[i] *= (i + i / 4) % 2 ? 0.4 : 1.6;
  const std::vector<double> times{0.2, 0.5};
  const Trajectory a = converged_motion(sheet, times, 1.0 / 256),
                   b = converged_motion(net, times, 1.0 / 256);
  ASSERT_TRUE(a.unique) << a.reason;
  ASSERT_TRUE(b.unique) << b.reason;
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t i = 0; i < 16; ++i) {
      EXPECT_LT((a.states[k].x[i] - b.states[k].x[i]).norm(), 1e-9 + a.floor[k] + b.floor[k]) << i;
      EXPECT_LT((a.states[k].v[i] - b.states[k].v[i]).norm(), 1e-4) << i;
    }
  EXPECT_GT((b.states[1].x[15] - net.start.x[15]).norm(), 0.5) << "it swings";
}

// Anything that bends or shears a row turns the sheet into one whose links lock.
TEST(Shake, ASheetWhoseRowsWouldNotStayStraightIsRefused) {
  const Scene straight = rows_let_go({.shear = true});
  const std::vector<std::function<void(Scene&)>> changes{
      [](Scene& s) {
        s.pins = {0, 1, 2};
      },
      [](Scene& s) {
        s.pins = {0, 3};
      },
      [](Scene& s) { s.pins.push_back(4); },
      [](Scene& s) { s.gravity.x() = 1; },
      [](Scene& s) { s.links.pop_back(); },
      [](Scene& s) { s.links[20].rest *= 1.001; },
      [](Scene& s) {
        s.start.v[9] = {0, 0, 1};
      },
      [](Scene& s) { s.start.x[9].z() += 0.01; },
      [](Scene& s) { s.start.x[9].x() += 0.01; },
      [](Scene& s) {
        s.pin_motions = {{{0}, {.velocity = {0, 1, 0}}}};
      },
      [](Scene& s) {
        s.wind = Wind{.velocity = {0, 0, 1}, .strength = 1};
      },
      [](Scene& s) { s.mesh.grid.reset(); },
      [](Scene& s) {  // turned within its plane: columns lean towards their neighbours
        for (std::size_t i = 4; i < 16; ++i) s.start.x[i].x() += 0.1 * static_cast<double>(i / 4);
      }};
  EXPECT_TRUE(converged_motion(straight, {0.1}, 1.0 / 64).unique);
  for (std::size_t c = 0; c < changes.size(); ++c) {
    Scene scene = straight;
    changes[c](scene);
    EXPECT_FALSE(converged_motion(scene, {0.1}, 1.0 / 64).unique) << c;
  }
}

TEST(Shake, RefusesContactAndLockingLinks) {
  EXPECT_FALSE(converged_motion(two_corners(4, 1, {.shear = true}), {0.1}, 1e-3).unique);
  Scene s = two_corners(4, 0.8);
  EXPECT_FALSE(converged_motion(s, {0.1}, 1e-3).unique);  // stretched at the start
  s.stiffness.fill(100);
  EXPECT_TRUE(converged_motion(s, {0.1}, 1.0 / 1000).unique) << "springs may be stretched";
  s.stiffness.fill(1e12);
  EXPECT_TRUE(converged_motion(s, {0.1}, 1.0 / 1000).reason.starts_with("springs vibrate"));
}

}  // namespace
}  // namespace taut::reference::reference_test
