// Newton's method for implicit Euler against a second implementation, dense and from the equations.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

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

/// One iteration solves one linear system about x_t: H p = -g with the clamped Hessian of springs.
TEST(Implicit, OneIterationIsBaraffAndWitkinsStep) {
  const Scene scene = irregular_net(5);
  const ElasticStep step(scene, kSoft);
  const std::vector<Vec3> linear = step.moved(scene.start.x, step.newton_direction(scene.start.x));
  const State mine = after_one_step(scene, "implicit:iterations=1,line-search=off," + kSoftText);
  EXPECT_LT(largest_distance(mine.x, linear), 1e-9);
  EXPECT_GT(largest_distance(step.minimum(), linear), 1e-5);  // it is not the minimum
  // where the full step, too, would raise the energy
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

TEST(Implicit, BeginsWhereInertiaLeadsIfItIsTold) {
  const Scene scene = irregular_net(6);
  const ElasticStep step(scene, kSoft);
  const std::vector<Vec3>& y = step.prediction();
  const std::vector<Vec3> linear = step.moved(y, step.newton_direction(y));
  const auto after = [&](const std::string& how) {
    return after_one_step(scene, "implicit:" + how + "," + kSoftText).x;
  };
  EXPECT_LT(largest_distance(after("start=inertia,iterations=1,line-search=off"), linear), 1e-9);
  EXPECT_GT(largest_distance(after("iterations=1,line-search=off"), linear), 1e-5);
  EXPECT_LT(largest_distance(after("start=inertia"), step.minimum()), 1e-9);
}

/// With contact, the step starts at the end of the last step.
TEST(Implicit, RestsOnABallWhereverItsStepsBegin) {
  Scene scene = hanging_sheet(9, 9);
  scene.stiffness = {1e3, 1e3, 1};
  for (Vec3& x : scene.start.x) x = {x.x() - 0.5, 0.36, x.y() + 0.5};
  scene.pins.clear();
  scene.thickness = 0.005;
  scene.colliders = {{.shape = Ball{Vec3::Zero(), 0.3}, .friction = 0.5}};
  const State last = simulate(scene, "implicit", 32);
  const State inertia = simulate(scene, "implicit:start=inertia", 32);
  EXPECT_LT(largest_distance(last.x, inertia.x), 1e-8);
  double deepest = 1;
  for (const Vec3& x : last.x) deepest = std::min(deepest, x.norm());
  EXPECT_NEAR(deepest, 0.305, 1e-6) << "it touches";
}

/// The reference for convergence is the minimum of the scene's step with damping, wind and moving
/// pins, each alone and all combinations of them.
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
    // pins count neither in the distance nor in the mass
    std::vector<Vec3> shifted = mine;
    for (std::size_t i = 0; i < mine.size(); ++i) shifted[i] += Vec3(0.3, 0, 0.4);
    for (const int pin : scene.pins) shifted[to_index(pin)] = mine[to_index(pin)];
    EXPECT_NEAR(step.square_distance(shifted, mine), 0.25, 1e-12);
  }
}

/// A steadily moving frame is equivalent to a frame at rest, even if pins cross several links per
/// step. A cape linearised with its pins ahead of it would end upside down above them.
TEST(EverySolver, SeesASteadilyMovingClothAsOneAtRest) {
  Scene still = hanging_sheet(5, 5);
  for (std::size_t i = 0; i < still.start.x.size(); ++i) still.start.v[i] = {0, 0, 0.3};
  for (const int pin : still.pins) still.start.v[to_index(pin)].setZero();
  for (const char* solver :
       {"implicit", "implicit:start=inertia", "implicit:linear=cg", "pd", "admm", "vbd", "avbd",
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

/// In equilibrium the weight determines the tension, so strain is tension / (K r).
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

TEST(KeptMultipliers, ConvergeToTheSameStep) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Scene scene = irregular_net(seed);
    const std::vector<Vec3> exact = ElasticStep(scene, kSoft).minimum();
    EXPECT_LT(largest_distance(
                  after_one_step(scene, "implicit:multipliers=keep,iterations=200," + kSoftText).x,
                  exact),
              1e-9);
  }
}

/// The sheet is drawn to the side and released; at this stiffness Newton's method from x_t needs
/// many iterations.
TEST(KeptMultipliers, MoveStiffClothRightWithThreeIterations) {
  Scene scene = hanging_sheet(12, 12, {true, true, false});
  scene.pins.clear();
  for (int i = 0; i < 12; ++i) scene.pins.push_back(i);
  for (Vec3& x : scene.start.x) x = {x.x(), x.y() * std::sqrt(0.5), -x.y() * std::sqrt(0.5)};
  for (const char* k : {"1e4", "1e6"}) {
    const std::string springs = std::string("structural=") + k + ",shear=" + k;
    const std::vector<Vec3> exact = simulate(scene, "implicit:iterations=100," + springs, 32).x;
    const auto off = [&](const std::string& how) {
      return largest_distance(simulate(scene, "implicit:" + how + "," + springs, 32).x, exact);
    };
    EXPECT_LT(off("multipliers=keep,iterations=3"), 3e-3) << k;
    if (k == std::string("1e6")) {
      EXPECT_GT(off("iterations=3"), 0.02);
    }
  }
}

/// The tensions of the last step keep slack cloth from folding at random.
TEST(KeptMultipliers, HoldSlackClothWithTwoIterations) {
  Scene scene = crumpled(hanging_sheet(12, 12, {true, false, false}), 1e-3);
  scene.damping = 0.5;
  for (const int pin : scene.pins) scene.start.x[to_index(pin)].x() = pin == 0 ? 0.15 : 0.85;
  const State end = simulate(scene, "implicit:multipliers=keep,iterations=2,structural=1e4", 96);
  for (const Link& l : scene.links)
    EXPECT_LT((end.x[to_index(l.b)] - end.x[to_index(l.a)]).norm(), 1.02 * l.rest);
}

/// A step with contact is plain Newton, and tensions start again at zero. With enough iterations a
/// cloth that falls on a ball, or lies on it, is where it is without kept multipliers.
TEST(KeptMultipliers, FallOnABallAndRestThereAsWithoutThem) {
  for (const bool rests : {false, true}) {
    Scene scene = hanging_sheet(9, 9);
    scene.stiffness = {1e3, 1e3, 1};
    for (Vec3& x : scene.start.x) x = {x.x() - 0.5, rests ? 0.31 : 0.36, x.y() + 0.5};
    scene.pins = rests ? std::vector{0, 8, 72, 80} : std::vector<int>{};
    scene.damping = rests ? 5 : 0;
    scene.thickness = 0.005;
    scene.colliders = {{.shape = Ball{Vec3::Zero(), 0.3}, .friction = 0.5}};
    const std::string newton = "implicit:iterations=50";
    const int steps = rests ? 192 : 32;
    const State end = simulate(scene, newton + ",multipliers=keep", steps);
    EXPECT_LT(largest_distance(end.x, simulate(scene, newton, steps).x), 1e-8) << rests;
    double deepest = 1;
    for (const Vec3& x : end.x) deepest = std::min(deepest, x.norm());
    EXPECT_NEAR(deepest, 0.305, 1e-6) << "it touches";
  }
}

TEST(KeptMultipliers, RefuseRigidLinksAsSpringsDo) {
  Scene scene = hanging_sheet(3, 3);
  scene.stiffness[0] = 1e3;
  const SolverChoice choice = parse_solver("implicit:multipliers=keep");
  const std::vector<std::string> why = choice.entry->unsupported(scene, choice.params);
  ASSERT_EQ(why.size(), 2u);
  EXPECT_EQ(why[0], "shear links are rigid: springs need their stiffness in [links] stiffness");
}

/// A mass on a spring from a pin. The spring is linear along its axis, so that the z of a step is
/// known.
Scene oscillator(double dt) {
  Scene scene = hanging_sheet(1, 2, {true, false, false});
  scene.gravity.setZero();
  scene.dt = dt;
  scene.start.x[1].y() -= 0.05;
  return scene;
}

TEST(Integrators, KeepWhatTheyShouldOfASwing) {
  const double k = 10;
  for (const double dt : {1.0 / 64, 1.0 / 32}) {
    const Scene scene = oscillator(dt);
    const double w2 = k / scene.mesh.mass[1], w = std::sqrt(w2);
    const auto energy = [&](const State& s) {
      const double stretch = scene.start.x[0].y() - s.x[1].y() - scene.links[0].rest;
      return s.v[1].squaredNorm() + w2 * stretch * stretch;
    };
    const auto ratio = [&](const std::string& integrator, int steps) {
      return energy(simulate(scene, "implicit:structural=10,integrator=" + integrator, steps)) /
             energy(scene.start);
    };
    EXPECT_NEAR(ratio("midpoint", 64), 1, 1e-9);
    EXPECT_NEAR(ratio("euler", 10), std::pow(1 + w2 * dt * dt, -10), 1e-9);
    // BDF2's principal root: (3 - 2 i w dt) z^2 - 4 z + 1 = 0
    const std::complex<double> a(3, -2 * w * dt), z = (2.0 + std::sqrt(4.0 - a)) / a;
    EXPECT_NEAR(ratio("bdf2", 200) / ratio("bdf2", 100), std::pow(std::norm(z), 100),
                0.02 * std::pow(std::norm(z), 100));
  }
}

TEST(Integrators, HaveTheOrdersOneTwoTwo) {
  const auto error = [&](const std::string& integrator, int steps) {
    const Scene scene = oscillator(0.5 / steps);
    const double w = std::sqrt(10 / scene.mesh.mass[1]);
    const State end = simulate(scene, "implicit:structural=10,integrator=" + integrator, steps);
    return std::abs(scene.start.x[0].y() - end.x[1].y() - scene.links[0].rest -
                    0.05 * std::cos(0.5 * w));
  };
  for (const auto& [integrator, order] :
       {std::pair<std::string, double>{"euler", 1}, {"bdf2", 2}, {"midpoint", 2}})
    EXPECT_NEAR(std::log2(error(integrator, 256) / error(integrator, 512)), order, 0.1)
        << integrator;
}

TEST(Integrators, SayWhatTheyDoNotKnow) {
  Scene scene = hanging_sheet(3, 3);
  const auto refused = [&](const std::string& integrator) {
    const SolverChoice choice = parse_solver("implicit:integrator=" + integrator);
    return choice.entry->unsupported(scene, choice.params).size();
  };
  EXPECT_EQ(refused("bdf2"), 0u);
  scene.damping = 1;
  scene.wind = Wind{};
  scene.colliders = {{.shape = Plane{.offset = -3}}};
  EXPECT_EQ(refused("bdf2"), 3u);
  EXPECT_EQ(refused("midpoint"), 3u);
  EXPECT_EQ(refused("euler"), 0u);
}

}  // namespace
}  // namespace taut::implicit_test
