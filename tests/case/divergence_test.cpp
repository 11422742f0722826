// Verdicts at their thresholds: slightly below is legitimate, slightly above is not.
#include "experiments/case/divergence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "experiments/case/run_case.hpp"
#include "experiments/study/frontier/frontier.hpp"
#include "tests/support/cloths.hpp"

namespace taut::divergence_test {
namespace {

Scene chain() { return hanging_sheet(1, 9, {true, false, false}, Lumping::equal); }

std::vector<PassCost> sweeps(std::size_t k) {
  return {{.pass = "structural", .repeats = k, .projections = true}};
}

/// State in which vertex 5 moves at `speed` [m/s]; the kinetic energy is m speed^2/2.
State moving(const Scene& scene, double speed) {
  State state = scene.start;
  state.v[5] = {speed, 0, 0};
  return state;
}

TEST(VerdictBorders, TenTimesTheAvailableEnergy) {
  const Scene scene = chain();
  for (const int step : {1, 10, 64}) {
    const double t = step * scene.dt;
    const double limit = std::sqrt(20 * EnergyBudget(scene).available(t) / scene.mesh.mass[5]);
    DivergenceDetector below(scene, {}), above(scene, {});
    EXPECT_TRUE(below.observe(step, t, moving(scene, 0.9999 * limit))) << step;
    EXPECT_FALSE(above.observe(step, t, moving(scene, 1.0001 * limit))) << step;
    EXPECT_EQ(above.status().reason, Reason::energy);
    EXPECT_EQ(above.status().step, step);
    EXPECT_EQ(above.status().vertex, 5);
  }
}

TEST(VerdictBorders, PinsHaveNoEnergyButMustBeFinite) {
  const Scene scene = chain();
  State state = scene.start;
  state.v[0] = {1e9, 0, 0};
  EXPECT_TRUE(DivergenceDetector(scene, {}).observe(1, scene.dt, state));
  state.v[0].y() = -std::numeric_limits<double>::infinity();
  DivergenceDetector verdict(scene, {});
  EXPECT_FALSE(verdict.observe(1, scene.dt, state));
  EXPECT_EQ(verdict.status().reason, Reason::nonfinite);
  EXPECT_EQ(verdict.status().vertex, 0);
}

TEST(VerdictBorders, TheEndOfTheWorld) {
  const Scene scene = chain();
  const double bound = EnergyBudget(scene).farthest(scene.dt);
  EXPECT_GT(bound, 1e3);  // a chain of 1 m that falls for one step
  EXPECT_LT(bound, 1e5);
  for (const double side : {-bound, bound}) {
    State state = scene.start;
    state.x[3].z() = side;
    EXPECT_TRUE(DivergenceDetector(scene, {}).observe(1, scene.dt, state));
    state.x[3].z() = std::nextafter(side, 2 * side);
    DivergenceDetector verdict(scene, {});
    EXPECT_FALSE(verdict.observe(1, scene.dt, state));
    EXPECT_EQ(verdict.status().reason, Reason::box);
    EXPECT_EQ(verdict.status().vertex, 3);
  }
}

/// Status after step 7 if the link from vertex 4 to vertex 5 has the strain `strain`.
Status strained(const Scene& scene, double strain) {
  State state = scene.start;
  for (std::size_t i = 5; i < state.x.size(); ++i) state.x[i].y() -= strain * scene.links[4].rest;
  DivergenceDetector verdict(scene, {});
  EXPECT_TRUE(verdict.observe(6, 6 * scene.dt, scene.start));
  EXPECT_TRUE(verdict.observe(7, 7 * scene.dt, state));
  verdict.finish();
  return verdict.status();
}

TEST(VerdictBorders, AStrainOfTwoIsExtremeBesideSoftRelaxation) {
  Scene scene = chain();
  EXPECT_EQ(legitimate_strain(scene), 2);
  EXPECT_EQ(strained(scene, 1.99).kind, Status::Kind::ok);
  const Status status = strained(scene, 2.01);
  EXPECT_EQ(status.kind, Status::Kind::extreme);
  EXPECT_EQ(status.reason, Reason::stretch);
  EXPECT_EQ(status.step, 7);
  EXPECT_EQ(status.vertex, 4);

  scene.dt = 0.1;  // truth 5.5: a chain of N free particles is strained by 2 (N - 1) g dt^2/l
  const double truth = 2 * 7 * scene.gravity.norm() * scene.dt * scene.dt / scene.links[0].rest;
  EXPECT_GT(truth, 10);
  EXPECT_LT(2 * truth, 30);
  EXPECT_EQ(strained(scene, truth).kind, Status::Kind::ok);
  EXPECT_EQ(strained(scene, 2.01 * truth).kind, Status::Kind::extreme);

  scene.dt = 10;
  EXPECT_EQ(legitimate_strain(scene), 30) << "the bound never exceeds 30";
  scene = chain();
  for (Vec3& x : scene.start.x) x *= 12;
  DivergenceDetector verdict(scene, {});
  EXPECT_TRUE(verdict.observe(0, 0, scene.start));
  EXPECT_EQ(verdict.status().kind, Status::Kind::extreme) << "and starts there";
}

TEST(VerdictBorders, ABendLinkAndOneBetweenPinsAreNeverExtreme) {
  Scene scene = hanging_sheet(1, 9, {true, false, true}, Lumping::equal);
  for (Link& link : scene.links)
    if (link.family == Family::bend) link.rest *= 1e-3;
  EXPECT_EQ(strained(scene, 0).kind, Status::Kind::ok);
  scene.pins = {4, 5};
  EXPECT_EQ(strained(scene, 50).kind, Status::Kind::ok);
}

/// Verdict on a run of `times` settling times in which a vertex never slows down.
Status restless(double speed, double times, double strain = 0) {
  Scene scene = chain();
  const std::vector<PassCost> step_cost = sweeps(64);
  scene.steps = static_cast<int>(std::ceil(times * *settling_time(scene, step_cost) / scene.dt));
  DivergenceDetector verdict(scene, step_cost);
  State state = moving(scene, speed);
  for (std::size_t i = 5; i < state.x.size(); ++i) state.x[i].y() -= strain * scene.links[4].rest;
  for (int n = 1; n <= scene.steps; ++n)  // at the start no energy is available
    EXPECT_TRUE(verdict.observe(n, n * scene.dt, state));
  verdict.finish();
  return verdict.status();
}

TEST(VerdictBorders, RestIsAThousandthOfTheFreeFallSpeed) {
  const Scene scene = chain();
  const double slow = 1e-3 * std::sqrt(scene.gravity.norm() * extent(scene));
  EXPECT_EQ(restless(0.999 * slow, 6).kind, Status::Kind::ok);
  const Status status = restless(1.001 * slow, 6);
  EXPECT_EQ(status.kind, Status::Kind::unsettled);
  EXPECT_EQ(status.vertex, 5);
}

TEST(VerdictBorders, NobodyIsUnsettledBeforeFiveSettlingTimes) {
  EXPECT_EQ(restless(0.1, 4.9).kind, Status::Kind::ok);
  EXPECT_EQ(restless(0.1, 5.1).kind, Status::Kind::unsettled);
}

TEST(VerdictBorders, WhatIsExtremeAndDoesNotSettleIsNoStableProbe) {
  for (const double speed : {0.0, 0.1}) {
    const Status status = restless(speed, 6, 11);
    EXPECT_EQ(status.kind, Status::Kind::extreme);
    EXPECT_EQ((Probed{{status}, 1}).stable(), speed == 0) << status.reason.text();
  }
}

// The last of five settling times begins after four. By then a decaying swing is down to e^-4 of
// its largest speed.
TEST(VerdictBorders, ASwingThatDecaysAsTheorySaysIsSettled) {
  Scene scene = chain();
  const std::vector<PassCost> step_cost = sweeps(64);
  const double settling = *settling_time(scene, step_cost);
  scene.steps = static_cast<int>(std::ceil(5.5 * settling / scene.dt));
  for (const double rate : {1.001, 0.8}) {
    DivergenceDetector verdict(scene, step_cost);
    for (int n = 1; n <= scene.steps; ++n)
      ASSERT_TRUE(verdict.observe(n, n * scene.dt,
                                  moving(scene, std::exp(-rate * n * scene.dt / settling))));
    verdict.finish();
    EXPECT_EQ(verdict.status().kind, rate > 1 ? Status::Kind::ok : Status::Kind::unsettled) << rate;
  }
}

// Weightless spring, stretched by 4 % and released. Below dt = 2/w Verlet bounds its swing to
// 1/sqrt(1 - (w dt/2)^2) of the initial stretch; above, the swing grows. The energy stored at the
// start allows for the bounded swing.
TEST(StoredEnergy, ASpringExplodesAboveTheStabilityLimitAlone) {
  constexpr double kMass = 0.1, kStiffness = 20;  // kg, N/m
  Scene scene = hanging_sheet(1, 2, {true, false, false}, Lumping::equal);
  scene.mesh.mass.assign(2, kMass);
  scene.gravity.setZero();
  scene.start.x[1] = scene.start.x[0] + 1.04 * (scene.start.x[1] - scene.start.x[0]);
  const double limit = 2 / std::sqrt(kStiffness / kMass);
  const auto status = [&](double share) {
    scene.dt = share * limit;
    scene.steps = 400;
    return run_case(scene, parse_solver("mass-spring:structural=20,substeps=1,precision=double"))
        .record.status;
  };
  for (const double share : {0.5, 0.8, 0.85, 0.95, 0.99, 0.997})
    EXPECT_EQ(status(share).kind, Status::Kind::ok) << share;
  for (const double share : {1.001, 1.01, 1.1}) {
    EXPECT_EQ(status(share).kind, Status::Kind::exploded) << share;
    EXPECT_EQ(status(share).reason, Reason::energy) << share;
  }
}

TEST(StoredEnergy, IsThatOfTheStiffestSpringThatAStepCanHold) {
  Scene scene = hanging_sheet(1, 2, {true, false, false}, Lumping::equal);
  scene.gravity.setZero();
  const double before = EnergyBudget(scene).available(scene.dt);
  scene.start.x[1] *= 1.04;
  // (2n + 1)^2 of m (2/dt)^2 e^2/2 after n = 1 step, plus (e/dt)^2 m/2 for the jump of a
  // projection.
  const double e = 0.04 * scene.links[0].rest, m = scene.mesh.mass[1];
  EXPECT_NEAR(EnergyBudget(scene).available(scene.dt) - before,
              (9 * 4 + 1) * m / 2 * e * e / scene.dt / scene.dt, 1e-9);
}

}  // namespace
}  // namespace taut::divergence_test
