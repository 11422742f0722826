// Upper bound of the energy that a scene can put into a cloth, part by part as in divergence.hpp,
// and the time that a cloth takes to settle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "experiments/case/divergence.hpp"
#include "tests/support/cloths.hpp"

namespace taut::budget_test {
namespace {

constexpr double kG = 9.81;

/// Chain of four links of 0.25 m between vertices of 0.04 kg, hung from the first; dt = 1/64 s, no
/// gravity.
Scene chain(const Vec3& gravity = Vec3::Zero()) {
  Scene scene = hanging_sheet(1, 5, {true, false, false}, Lumping::equal);
  scene.gravity = gravity;
  return scene;
}

/// Energy budget of the second scene at time t beyond that of the first [J].
double more(const Scene& plain, const Scene& scene, double t) {
  return EnergyBudget(scene).available(t) - EnergyBudget(plain).available(t);
}

TEST(Budget, AtRestThereIsNothingButRounding) {
  Scene scene = chain();
  // the first vertex is farthest from the origin, 500.8 m
  for (Vec3& x : scene.start.x) x += Vec3(300, 401, 0);
  const double off = 1e-6 * (std::hypot(300, 401) + 1) * 64;
  EXPECT_NEAR(EnergyBudget(scene).available(3), 0.16 / 2 * off * off, 1e-12);
}

TEST(Budget, DoesNotDependOnHowAMotionIsCutIntoSteps) {
  Scene whole = chain(Vec3(0, -kG, 0));
  whole.thickness = 0.125;
  whole.colliders = {{.shape = Ball{{0, -0.5, 0}, 0.0625}}};
  whole.start.x[4].y() -= 0.75;
  whole.damping = 0.25;
  Scene cut = whole;
  cut.dt /= 32;
  for (const double t : {0.0, 0.25, 4.0})
    EXPECT_NEAR(EnergyBudget(whole, 32).available(t) / EnergyBudget(cut).available(t), 1, 1e-12);
  whole.dt = 4;
  cut.dt = 0.125;
  EXPECT_EQ(legitimate_strain(whole, 32), legitimate_strain(cut));
  EXPECT_LT(legitimate_strain(whole, 32), legitimate_strain(whole));
  whole.colliders.clear();
  cut.colliders.clear();
  const auto sweeps = [](std::size_t each) {
    return std::vector<PassCost>{{.pass = "links", .repeats = each, .projections = true}};
  };
  EXPECT_NEAR(*settling_time(whole, sweeps(32 * 2), 32), *settling_time(cut, sweeps(2)), 1e-9);
}

TEST(Budget, WhatMovesAtTheStartHasItsKineticEnergy) {
  Scene scene = chain();
  scene.start.v[2] = {3, 0, 4};
  scene.start.v[4] = {0, 1, 0};
  EXPECT_NEAR(more(chain(), scene, 1), 0.04 * (25 + 1) / 2, 1e-12);
  scene.start.v[0] = {7, 7, 7};
  EXPECT_NEAR(more(chain(), scene, 1), 0.52, 1e-12) << "a pin has none";
}

TEST(Budget, AHungPieceFallsAtMostTwiceItsLength) {
  const Vec3 down(0.6 * kG, -0.8 * kG, 0);
  const Scene scene = chain(down);
  const double dt = scene.dt, fall = kG * 0.1 * (0.1 + dt) / 2;
  EXPECT_NEAR(more(chain(), scene, 0.1), 0.16 * kG * fall, 1e-12);
  // Cut j carries the 5 - j masses below it and yields with w = 1/m for the first cut, otherwise
  // 2/m.
  const double stretch = (4 + 2 * (3 + 2 + 1)) * kG * dt * dt;
  EXPECT_NEAR(more(chain(), scene, 100), 0.16 * kG * 2 * (1 + stretch), 1e-12);
  Scene cut = scene;  // the lower two vertices fall freely
  cut.links.erase(cut.links.begin() + 2);
  const double rest = (2 + 2 * 1) * kG * dt * dt, far = kG * 100 * (100 + dt) / 2;
  EXPECT_NEAR(more(chain(), cut, 100), kG * (0.08 * far + 0.08 * 2 * (0.5 + rest)), 1e-6);
  cut.pins.clear();
  EXPECT_NEAR(more(chain(), cut, 0.1) / (0.2 * kG * fall), 1, 1e-6) << "and without a pin all do";
}

// Two columns: both links of a cut share the load below them.
TEST(Budget, ManyLinksOfACutShareTheirLoad) {
  Scene scene = hanging_sheet(2, 3, {true, false, false}, Lumping::equal), weightless = scene;
  weightless.gravity.setZero();
  const double m = 0.2 / 6, dt2 = scene.dt * scene.dt;
  const double stretch = (4 * m * (2 / m) + 2 * m * (4 / m)) / 4 * kG * dt2;
  EXPECT_NEAR(more(weightless, scene, 100), 4 * m * kG * 2 * (2 + stretch), 1e-12);
}

TEST(Budget, WindBlowsByItsLaw) {
  Scene plain = hanging_sheet(3, 2, {true, false, false});
  plain.pins.clear();
  plain.gravity.setZero();
  Scene scene = plain;
  scene.wind = Wind{.velocity = {2, 3, 6}, .strength = 0.5};  // wind of 7 m/s on 0.5 m^2
  EXPECT_NEAR(more(plain, scene, 3), 0.5 * 0.5 * 49 / 4 * 3, 1e-12);
  scene.wind->law = Wind::Law::literal;
  const double lightest = 0.2 / 8, speed = 0.5 * 0.5 * 7 / lightest * 3;
  EXPECT_NEAR(more(plain, scene, 3), 0.2 / 2 * speed * speed, 1e-9);
}

TEST(Budget, OfAClothThatIsAllPinnedIsANumber) {
  Scene scene = hanging_sheet(3, 2);
  scene.pins = {0, 1, 2, 3, 4, 5};
  scene.wind = Wind{.velocity = {2, 3, 6}, .strength = 0.5, .law = Wind::Law::literal};
  EXPECT_TRUE(std::isfinite(EnergyBudget(scene).available(3)));
  EXPECT_TRUE(std::isfinite(EnergyBudget(scene).farthest(3)));
}

TEST(Budget, EveryChangeOfAPrescribedVelocityCounts) {
  const auto of = [](const Motion& motion) {
    Scene scene = chain();
    scene.pin_motions = {{{0}, motion}};
    return std::sqrt(more(chain(), scene, 1) / (0.16 / 2)) / 2;  // sum of speeds
  };
  EXPECT_NEAR(of({.velocity = {2, 3, 6}}), 7, 1e-9);
  EXPECT_NEAR(of({.path = {{0, {0, 0, 0}}, {1, {2, 0, 0}}, {3, {2, 0, 6}}}}),
              2 + std::sqrt(2 * 2 + 3 * 3) + 3, 1e-9);
  EXPECT_NEAR(of({.velocity = {1, 0, 0}, .path = {{0, {0, 0, 0}}, {0.5, {0, 2, 0}}}}), 1 + 4 + 4,
              1e-9);
  // The distance from a pivot is bounded by the farthest start plus both sizes of the cloth.
  EXPECT_NEAR(of({.spin = {0, 0, 2}, .pivot = {3, 0, 0}}), 2 * (std::hypot(3, 1) + 2), 1e-9);
  Scene scene = chain();
  scene.pin_motions = {{{0}, {.velocity = {1, 0, 0}}}};
  scene.colliders = {{.shape = Ball{{9, 0, 0}, 1}, .motion = {.velocity = {0, 5, 0}}}};
  EXPECT_NEAR(more(chain(), scene, 1), 0.16 / 2 * 12 * 12, 1e-9) << "all of them together";
}

TEST(Budget, ABrokenStartIsRepairedInOneStep) {
  const double unit = 0.16 / 2 * 64 * 64;  // J for one metre per step
  Scene scene = chain();
  scene.thickness = 0.125;
  scene.colliders = {{.shape = Plane{Vec3::UnitY(), -0.75}}, {.shape = Ball{{9, 0, 0}, 1}}};
  EXPECT_NEAR(more(chain(), scene, 1), unit * 0.375 * 0.375, 1e-9);
  scene.self_collision = SelfCollision{0.0625};
  EXPECT_NEAR(more(chain(), scene, 1), unit * 0.5 * 0.5, 1e-9);
  // the last link is 0.75 m too long: projections repair it, springs store it
  Scene longer = chain();
  longer.start.x[4].y() -= 0.75;
  const double stored = 2 * 0.75 * 0.75 / (2 / 0.04) * 64 * 64, steps = 2 * 10 + 1;
  Scene same = chain();
  EXPECT_NEAR(more(same, longer, 10.0 / 64), unit * 0.75 * 0.75 + steps * steps * stored, 1e-4);
  // Links that are 40 m and 40.5 m too long move no vertex by more than the cloth's sizes, 1 m at
  // rest and 40.75 m at the start.
  Scene apart = chain();
  apart.start.x[3].y() += 40.5;
  const double held = 0.04 * (40 * 40 + 40.5 * 40.5) * 64 * 64;
  EXPECT_NEAR(more(same, apart, 0) / (unit * 41.75 * 41.75 + held), 1, 1e-6);
}

TEST(Budget, TheWorldEndsATensOfItsWaysAway) {
  Scene scene = chain({0, -kG, 0});
  for (Vec3& x : scene.start.x) x.x() += 2;
  scene.start.v[3] = {0, 0, 3};
  scene.start.v[1] = {1, 0, 0};
  scene.pin_motions = {{{0}, {.velocity = {0, 4, 0}}}};
  const double size = std::hypot(2, 1) + 1, dt = scene.dt;
  const auto farthest = [&](double speed, double acceleration, double t) {
    return 1e3 * size + 10 * (speed * t + acceleration * t * (t + dt) / 2);
  };
  EXPECT_NEAR(EnergyBudget(scene).farthest(0), 1e3 * size, 1e-9);
  EXPECT_NEAR(EnergyBudget(scene).farthest(3), farthest(7, kG, 3), 1e-9);
  scene.wind = Wind{.velocity = {0, 0, 5}, .strength = 1};
  EXPECT_NEAR(EnergyBudget(scene).farthest(3), farthest(12, kG, 3), 1e-9);
  EXPECT_EQ(EnergyBudget(scene).farthest(1e6), 1e6);
}

// The link with the largest opening for its length decides: here a short link below the middle.
TEST(LegitimateStrain, IsTwiceThatOfTheWorstCut) {
  Scene scene = hanging_sheet(1, 9, {true, false, false}, Lumping::equal);
  scene.links[5].rest /= 4;  // carries 3 of 8 vertices
  scene.dt = 0.08;
  const double strain = 2 * 3 * kG * scene.dt * scene.dt / scene.links[5].rest;
  EXPECT_GT(strain, 10);
  EXPECT_NEAR(legitimate_strain(scene), 2 * strain, 1e-9);
  scene.links[5].rest *= 4;
  EXPECT_NEAR(legitimate_strain(scene), 2 * 2 * 7 * kG * scene.dt * scene.dt / 0.125, 1e-9);
}

std::vector<PassCost> sweeps(std::size_t k) {
  return {{.pass = "verlet", .repeats = 1000},
          {.pass = "shear", .repeats = 2, .projections = true},
          {.pass = "structural", .repeats = k, .projections = true}};
}

TEST(SettlingTime, IsThatOfRelaxingAndOfSwinging) {
  for (const double damping : {0.0, 3.0})
    for (const std::size_t k : {4u, 64u}) {
      Scene scene = chain({0, 0, -kG});
      scene.damping = damping;
      const double dt = scene.dt, w = 1.2024 * std::sqrt(kG / 1);
      const double relaxing = 8.0 * 16 * dt / (std::numbers::pi * std::numbers::pi * double(k)),
                   decay = std::log(1 + w * w * dt * dt) / (2 * dt) + damping / 2;
      EXPECT_NEAR(*settling_time(scene, sweeps(k)), relaxing + 1 / decay, 1e-9);
    }
}

TEST(SettlingTime, IsUnknownWhereAnythingButGravityActs) {
  const auto known = [](auto change) {
    Scene scene = chain({0, -kG, 0});
    change(scene);
    return settling_time(scene, sweeps(4)).has_value();
  };
  EXPECT_TRUE(known([](Scene&) {}));
  EXPECT_TRUE(known([](Scene& s) { s.pin_motions = {{{0}, {}}}; })) << "that do not move";
  EXPECT_FALSE(known([](Scene& s) { s.pin_motions = {{{0}, {.velocity = {1, 0, 0}}}}; }));
  EXPECT_FALSE(known([](Scene& s) { s.wind = Wind{}; }));
  EXPECT_FALSE(known([](Scene& s) { s.self_collision = SelfCollision{0.01}; }));
  EXPECT_FALSE(known([](Scene& s) { s.colliders = {{.shape = Plane{Vec3::UnitY(), -9}}}; }));
  EXPECT_FALSE(known([](Scene& s) { s.gravity.setZero(); }));
  EXPECT_FALSE(known([](Scene& s) { s.links.pop_back(); })) << "a piece hangs from nothing";
  EXPECT_FALSE(known([](Scene& s) { s.pins = {0, 1, 2, 3, 4}; })) << "nothing can move";
}

TEST(Verdict, ASolverThatStoresAnotherClothIsInError) {
  const Scene scene = chain();
  for (const bool positions : {true, false}) {
    DivergenceDetector verdict(scene, {});
    State state = scene.start;
    (positions ? state.x : state.v).pop_back();
    EXPECT_FALSE(verdict.observe(7, 0.1, state));
    EXPECT_EQ(verdict.status().kind, Status::Kind::error);
    EXPECT_EQ(verdict.status().reason.text(),
              positions ? "stored 4 positions and 5 velocities of 5 vertices"
                        : "stored 5 positions and 4 velocities of 5 vertices");
    EXPECT_EQ(verdict.status().step, 7);
    EXPECT_EQ(verdict.status().vertex, -1);
  }
}

TEST(Verdict, TheFastestVertexIsNamedAndASecondExtremeIsNot) {
  const Scene scene = chain({0, -kG, 0});
  State state = scene.start;
  state.v[1] = {1e4, 0, 0};
  state.v[3] = {0, 2e4, 0};
  state.v[4] = {0, 0, 1.5e4};
  DivergenceDetector verdict(scene, {});
  EXPECT_FALSE(verdict.observe(5, 0.1, state));
  EXPECT_EQ(verdict.status().vertex, 3);
  State longer = scene.start;
  for (std::size_t i = 3; i < 5; ++i) longer.x[i].y() -= 4;
  DivergenceDetector first(scene, {});
  EXPECT_TRUE(first.observe(5, 0.1, longer));
  EXPECT_TRUE(first.observe(6, 0.1, longer));
  EXPECT_EQ(first.status().step, 5);
  EXPECT_EQ(first.status().vertex, 2) << "the upper end of the link";
}

}  // namespace
}  // namespace taut::budget_test
