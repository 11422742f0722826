// XPBD with a global solve of all links: the result of one solve, the limit of the iterations, and
// how many of them are needed.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/reference/implicit_step.hpp"
#include "core/solver/simd/kernels.hpp"
#include "experiments/case/run_case.hpp"
#include "tests/solver/elastic_step.hpp"
#include "tests/support/cloths.hpp"

namespace taut::xpbd_global_test {
namespace {

const std::string kGlobal = "xpbd:method=global,substeps=1,precision=double,";

/// Chain that hangs straight from its first vertex, stretched by its own weight.
Scene loaded_chain(double stiffness) {
  Scene scene = hanging_sheet(1, 12, {true, false, false});
  scene.stiffness = {stiffness, stiffness, stiffness};
  double below = 0, drop = 0;
  std::vector<double> stretch;
  for (std::size_t i = scene.start.x.size(); i-- > 1;) {
    below += scene.mesh.mass[i] * scene.gravity.norm();
    stretch.insert(stretch.begin(), below / stiffness);
  }
  for (std::size_t i = 1; i < scene.start.x.size(); ++i)
    scene.start.x[i].y() -= drop += stretch[i - 1];
  return scene;
}

/// -lambda/h^2 is K C: along the links the problem is linear, so one solve holds the chain.
TEST(GlobalXpbd, HoldsALoadedChainWithOneSolution) {
  const Scene scene = loaded_chain(1e4);
  const State end = after_one_step(scene, kGlobal + "iterations=1");
  EXPECT_LT(largest_distance(end.x, scene.start.x), 1e-14);
  double below = 0;
  for (std::size_t i = end.x.size(); i-- > 1;) {
    below += scene.mesh.mass[i] * scene.gravity.norm();
    const double excess = (end.x[i] - end.x[i - 1]).norm() - scene.links[i - 1].rest;
    EXPECT_NEAR(1e4 * excess / below, 1, 1e-9);
  }
  // from unloaded lengths one solve is the step, too; sweeps need as many iterations as links
  Scene unloaded = scene;
  unloaded.start = {scene.mesh.rest, scene.start.v};
  const std::vector<Vec3> exact = ElasticStep(unloaded, unloaded.stiffness).minimum();
  EXPECT_LT(largest_distance(after_one_step(unloaded, kGlobal + "iterations=1").x, exact), 1e-13);
  EXPECT_GT(largest_distance(
                after_one_step(unloaded, "xpbd:substeps=1,precision=double,iterations=3").x, exact),
            1e-5);
}

/// The strain is the weight below over K = 1/(a h^2), where a is 1e-9 of the mean of 1/m + 1/m over
/// the ends of links.
TEST(GlobalXpbd, LeavesRigidLinksTheStrainOfItsRegularisation) {
  Scene scene = loaded_chain(1e6);
  scene.stiffness = kRigid;
  scene.start.x = scene.mesh.rest;
  const std::vector<double> w = inverse_masses(scene);
  double diagonal = 0, below = 0;
  for (std::size_t i = 1; i < w.size(); ++i)
    diagonal += (w[i - 1] + w[i]) / static_cast<double>(w.size() - 1);
  const State end = after_one_step(scene, kGlobal + "iterations=2");
  for (std::size_t i = end.x.size(); i-- > 1;) {
    below += scene.mesh.mass[i] * scene.gravity.norm();
    const double excess = (end.x[i] - end.x[i - 1]).norm() - scene.links[i - 1].rest;
    EXPECT_NEAR(excess / (below * 1e-9 * diagonal * scene.dt * scene.dt), 1, 1e-4);
  }
}

/// Sheet with equal masses, pinned along its top edge and released at 45 degrees from rest.
Scene swinging(int n, double k) {
  Scene scene = hanging_sheet(n, n, {true, true, false}, Lumping::equal);
  scene.stiffness = {k, k, k};
  scene.pins.clear();
  for (int i = 0; i < n; ++i) scene.pins.push_back(i);
  for (Vec3& x : scene.start.x) x = {x.x(), x.y() * std::sqrt(0.5), -x.y() * std::sqrt(0.5)};
  return scene;
}

/// Converged Newton's method reaches (-0.7932, -0.5972) after a second, for any K.
TEST(GlobalXpbd, MovesStiffClothRightWithThreeSolutions) {
  for (const double k : {1e4, 1e6}) {
    const Scene scene = swinging(32, k);
    const State end = simulate(scene, kGlobal + "iterations=3", 64);
    const Vec3 bottom = end.x[32 * 31 + 16];
    EXPECT_NEAR(bottom.y(), -0.7932, 2e-3) << k;
    EXPECT_NEAR(bottom.z(), -0.5972, 2e-3) << k;
  }
}

/// Without the primal residual both sweeps and solves converge to a point that depends on the
/// directions along their path; with it they converge to the implicit Euler step.
TEST(GlobalXpbd, WithThePrimalResidualGoesToImplicitEulersStep) {
  for (const double k : {1e4, 1e6}) {
    Scene scene = swinging(16, k);
    scene.start = simulate(scene, "implicit", 32);
    const reference::ImplicitStep step(scene, scene.start, 0, scene.stiffness);
    const auto exact = step.minimum(scene.start.x);
    ASSERT_EQ(exact.problem, "");
    const auto off = [&](const std::string& more) {
      return largest_distance(after_one_step(scene, kGlobal + more).x, exact.x);
    };
    EXPECT_LT(off("primal=on,iterations=64"), 1e-8) << k;
    if (k == 1e4) {
      EXPECT_LT(off("primal=on,iterations=32"), 1e-9) << "1e-8 by masses alone";
    }
    EXPECT_GT(off("iterations=64"), 1e-4) << k;
    EXPECT_NEAR(off("iterations=64"), off("iterations=32"), 1e-7) << k;
  }
  for (const unsigned seed : {1u, 2u, 3u}) {  // including slack nets
    Scene scene = irregular_net(seed);
    scene.stiffness = {800, 300, 50};
    EXPECT_LT(largest_distance(after_one_step(scene, kGlobal + "primal=on,iterations=300").x,
                               ElasticStep(scene, scene.stiffness).minimum()),
              1e-8)
        << seed;
  }
}

/// Iterations of one step until the error of the links' lengths is 1e-4 of its initial value.
int needed(const Scene& scene, const std::string& solver) {
  const auto off = [&](int iterations) {
    const State end = after_one_step(scene, solver + std::to_string(iterations));
    double sum = 0;
    for (const Link& l : scene.links)
      sum += std::pow((end.x[to_index(l.b)] - end.x[to_index(l.a)]).norm() - l.rest, 2);
    return std::sqrt(sum);
  };
  const double enough = 1e-4 * off(0);
  int low = 0, high = 1;
  while (off(high) > enough) high *= 2;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (off(middle) > enough ? low : high) = middle;
  }
  return high;
}
const std::string kSweeps = "xpbd:substeps=1,precision=double,order=mesh,iterations=";

/// Sheet with rigid links after half a second of motion.
TEST(GlobalXpbd, NeedsAsManySolutionsOnAFinerSheet) {
  const auto both = [&](int links) {
    Scene scene = swinging(links + 1, 1e6);
    std::erase_if(scene.links, [](const Link& l) { return l.family == Family::shear; });
    scene.start = simulate(scene, "implicit:multipliers=keep,iterations=6", 32);
    scene.stiffness = kRigid;
    return std::pair(needed(scene, kGlobal + "iterations="), needed(scene, kSweeps));
  };
  const auto coarse = both(8), fine = both(32);
  EXPECT_LE(coarse.first, 3);
  EXPECT_LE(std::abs(fine.first - coarse.first), 1);
  EXPECT_NEAR(std::log(1.0 * fine.second / coarse.second) / std::log(4), 2, 0.2);
}

/// A chain released from the side turns at its pin by h^2 g/l in the first step, and the tension of
/// all N links below acts across this angle: the first solve has an error of N^3 (h^2 g)^2/(2 L^2)
/// of a link. With time steps that keep this constant, the finest chain needs as many solves as the
/// coarsest.
TEST(GlobalXpbd, NeedsAsManySolutionsOnAFinerFallingChain) {
  const auto chain = [](int links, double dt) {
    Scene scene = hanging_sheet(1, links + 1, {true, false, false}, Lumping::equal);
    for (Vec3& x : scene.start.x) x = {0, x.y() * std::sqrt(0.5), -x.y() * std::sqrt(0.5)};
    scene.dt = dt;
    return scene;
  };
  for (const int links : {8, 16, 32, 64, 128}) {
    const double dt = std::pow(16.0 / links, 0.75) / 64;
    EXPECT_EQ(needed(chain(links, dt), kGlobal + "iterations="), 2) << links;
  }
  // at 1/64 s, 64 links make this error a link and more
  EXPECT_EQ(needed(chain(64, 1.0 / 64), kGlobal + "iterations="), 7);
  EXPECT_GT(needed(chain(64, 1.0 / 64), kSweeps), 10000);
}

/// Pins are in their places before the first solve.
TEST(GlobalXpbd, FollowsPinsThatMoveAndTheSceneDamping) {
  Scene scene = loaded_chain(1e4);
  scene.damping = 5;
  scene.pin_motions = {{{0}, {.velocity = {0, 0, 2}}}};
  for (Vec3& v : scene.start.v) v = {0, 0, 2};
  const State end = after_one_step(scene, kGlobal + "primal=on,iterations=64");
  const reference::ImplicitStep step(scene, scene.start, 0, scene.stiffness);
  EXPECT_LT(largest_distance(end.x, step.minimum(scene.start.x).x), 1e-8);
  EXPECT_NEAR(end.x[0].z(), 2 * scene.dt, 1e-12);
}

/// Solves of links and projections of bending alternate, as with sweeps; the sheet is held level at
/// one edge.
TEST(GlobalXpbd, BendsAsSweepsDo) {
  Scene scene = hanging_sheet(6, 6, {true, true, false});
  scene.stiffness = {1e3, 1e3, 1e3};
  for (Vec3& x : scene.start.x) x = {x.x(), 0, x.y()};
  scene.pins = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const auto one = [&](const std::string& solver) { return after_one_step(scene, solver).x; };
  const std::vector<Vec3> limp = one(kGlobal + "iterations=400");
  scene.bending = Bending{.warp = 1, .weft = 1};
  const std::vector<Vec3> global = one(kGlobal + "iterations=400"), sweeps = one(kSweeps + "4000");
  EXPECT_GT(largest_distance(limp, global), 1e-3);
  EXPECT_LT(largest_distance(sweeps, global), 1e-6);
}

/// A sheet held by its corners lies on a ball. With the primal residual contact is part of the
/// solve. Without it contact is projected after each solve, as after sweeps, and the sheet is still
/// nearer to the exact result than after ten times as many sweeps.
TEST(GlobalXpbd, LiesOnABallWhereItHasTo) {
  Scene scene = hanging_sheet(9, 9, {true, true, false});
  scene.stiffness = {1e3, 1e3, 1e3};
  for (Vec3& x : scene.start.x) x = {x.x() - 0.5, 0.31, x.y() + 0.5};
  scene.pins = {0, 8, 72, 80};
  scene.damping = 5;
  scene.thickness = 0.005;
  scene.colliders = {{.shape = Ball{Vec3::Zero(), 0.3}, .friction = 0.5}};
  const std::vector<Vec3> exact = simulate(scene, "implicit", 128).x;
  const auto off = [&](const std::string& solver) {
    const State end = simulate(scene, solver, 128);
    for (const Vec3& x : end.x) EXPECT_GT(x.norm(), 0.305 - 1e-9);
    return largest_distance(end.x, exact);
  };
  const double global = off(kGlobal + "iterations=20");
  EXPECT_LT(global, 3e-3);
  EXPECT_LT(global, off(kSweeps + "200"));
  EXPECT_LT(off(kGlobal + "primal=on,iterations=20"), 1e-6);
}

/// Regression: contact 1e9 times as stiff as inertia left the matrix of links without a factor.
TEST(GlobalXpbd, LaysRigidClothOnABall) {
  Scene scene = hanging_sheet(9, 9, {true, true, false});
  scene.pins.clear();
  for (Vec3& x : scene.start.x) x = {x.x() - 0.5, 0.36, x.y() + 0.5};
  scene.thickness = 0.005;
  scene.colliders = {Collider{Ball{Vec3::Zero(), 0.3}, {}, 0.5}};
  const State end =
      simulate(scene, "xpbd:method=global,primal=on,iterations=30,precision=double", 48);
  double nearest = 1;
  for (const Vec3& x : end.x) nearest = std::min(nearest, x.norm());
  EXPECT_NEAR(nearest, 0.305, 1e-4);
  double longest = 0;
  for (const Link& l : scene.links)
    longest = std::max(longest,
                       std::abs((end.x[to_index(l.b)] - end.x[to_index(l.a)]).norm() / l.rest - 1));
  EXPECT_LT(longest, 0.02);
}

/// Compressed links push their ends apart along directions that turn. Where this makes a mostly
/// slack sheet explode, the run reports a status instead of a wrong result.
TEST(GlobalXpbd, SaysThatASlackSheetBlowsUp) {
  Scene scene = crumpled(hanging_sheet(32, 32, {true, false, false}), 1e-3);
  scene.stiffness = {1e4, 1e4, 1e4};
  scene.damping = 0.5;
  scene.steps = 96;
  for (const int pin : scene.pins) scene.start.x[to_index(pin)].x() = pin == 0 ? 0.15 : 0.85;
  const auto status = [&](const std::string& solver) {
    return run_case(scene, parse_solver(solver)).record.status.kind;
  };
  for (const char* more : {"iterations=1", "iterations=2", "iterations=3"})
    EXPECT_NE(status(kGlobal + more), Status::Kind::ok) << more;
  EXPECT_EQ(status("implicit:multipliers=keep,iterations=3"), Status::Kind::ok);
}

TEST(GlobalXpbd, SaysWhatItDoesNotKnow) {
  Scene scene = hanging_sheet(3, 3);
  const auto refused = [&](const std::string& solver) {
    const SolverChoice choice = parse_solver(solver);
    return choice.entry->unsupported(scene, choice.params).size();
  };
  EXPECT_EQ(refused("xpbd:method=global"), 0u);
  EXPECT_EQ(refused("xpbd:method=global,primal=on"), 0u);
  EXPECT_EQ(refused("xpbd:primal=on"), 1u);
  EXPECT_EQ(refused("xpbd:method=global,multipliers=reset"), 1u);
  scene.colliders = {{.shape = Plane{.offset = -3}}};
  scene.bending = Bending{.warp = 1e-4, .weft = 1e-4};
  EXPECT_EQ(refused("xpbd:method=global"), 0u);
  EXPECT_EQ(refused("xpbd:method=global,primal=on,tethers=on"), 2u);
}

TEST(GlobalXpbd, GivesTheSameBitsEverywhere) {
  Scene plain = crumpled(hanging_sheet(14, 11, {true, true, false}), 0.01);
  Scene touching = plain;
  touching.colliders = {Collider{Ball{Vec3(0.5, -0.5, 0), 0.2}, {}, 0.3}};
  Scene bent = touching;
  bent.bending = Bending{.warp = 1e-4, .weft = 3e-4};
  for (const Scene& scene : {plain, touching, bent})
    for (const char* more : {"iterations=2,precision=float", "iterations=2,precision=double",
                             "iterations=2,precision=double,primal=on"}) {
      if (scene.bending && std::string_view(more).ends_with("on")) continue;
      const std::string method = std::string("xpbd:method=global,structural=1e-4,") + more;
      const State want = simulate(scene, method + ",simd=scalar", 4);
      const auto check = [&](const std::string& how) {
        const State now = simulate(scene, method + how, 4);
        EXPECT_EQ(std::memcmp(now.x.data(), want.x.data(), now.x.size() * sizeof now.x[0]), 0)
            << method << how;
      };
      for (const Simd simd : {Simd::sse2, Simd::avx2, Simd::avx512})
        if (available(simd)) check(",simd=" + std::string(to_string(simd)));
      check(",threads=2");
    }
}

}  // namespace
}  // namespace taut::xpbd_global_test
