// Performance profiles of made-up solvers with known costs.
#include "experiments/timing/profile.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace taut::profile_test {
namespace {

BenchedCase timed(const std::string& solver, double cost, double error,
                  Status::Kind status = Status::Kind::ok) {
  BenchedCase c;
  c.record.solver = solver;
  c.record.spec.solver = solver;
  c.record.dt = 1;
  c.record.status.kind = status;
  c.record.values["e"] = error;
  c.timing.samples = {cost, cost};
  return c;
}

SceneBench scene(std::vector<BenchedCase> cases) {
  return {"scene", {1, 1, 1}, std::move(cases), true, std::vector<Limit>{{"tunnelling.events", 0}}};
}

TEST(Profiles, AreSharesOfProblemsWithinAFactorOfTheBest) {
  const double levels[] = {0.1, 0.01};
  const auto found = performance_profiles(
      {scene({timed("a", 1, 0.05), timed("a", 4, 0.005), timed("b", 2, 0.05), timed("b", 2, 0.01)}),
       scene({timed("a", 6, 0.05), timed("a", 7, 0.05), timed("b", 2, 0.1), timed("b", 3, 0.2)})},
      "e", levels);
  // Problems: 0.1 and 0.01 on the first scene, 0.1 on the second. No solver reaches 0.01 on the
  // second.
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].ratios, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(found[1].ratios, (std::vector<double>{2, 1, 1}));
  EXPECT_DOUBLE_EQ(found[0].share(1), 1. / 3);
  EXPECT_DOUBLE_EQ(found[1].share(1), 2. / 3);
  EXPECT_DOUBLE_EQ(found[0].share(2.99), 2. / 3);
  EXPECT_DOUBLE_EQ(found[0].share(3), 1);
}

TEST(Profiles, WhatASceneDoesNotAcceptWinsNothing) {
  const double levels[] = {0.1};
  BenchedCase through = timed("a", 1, 0.01);
  through.record.values["tunnelling.events"] = 2;
  const auto found = performance_profiles(
      {scene({through, timed("a", 8, 0.01), timed("b", 9, 0.01), timed("b", 4, 0.01)})}, "e",
      levels);
  EXPECT_EQ(found[0].ratios, std::vector<double>{2}) << "its dear setting counts";
  EXPECT_EQ(found[1].ratios, std::vector<double>{1});
}

TEST(Profiles, AFailureIsInfinitelyDear) {
  const double levels[] = {0.1};
  const auto found = performance_profiles({scene({timed("a", 1, 0.01, Status::Kind::exploded),
                                                  timed("b", 5, 0.01), timed("c", 1, 0.5)})},
                                          "e", levels);
  EXPECT_TRUE(std::isinf(found[0].ratios[0]));
  EXPECT_EQ(found[1].share(1), 1);
  EXPECT_EQ(found[0].share(1e12), 0);
  EXPECT_TRUE(std::isinf(found[2].ratios[0]));
}

TEST(Profiles, AreOfAllSettings) {
  const double levels[] = {0.1};
  const auto found =
      performance_profiles({scene({timed("a", 9, 0.01), timed("a", 1, 0.01), timed("a", 8, 0.01),
                                   timed("b", 4, 0.01), timed("b", 5, 0.01)})},
                           "e", levels);
  EXPECT_EQ(found[0].ratios, std::vector<double>{1});
  EXPECT_EQ(found[1].ratios, std::vector<double>{4});
  EXPECT_EQ(PerformanceProfile{}.share(1), 0);
}

TEST(Profiles, ASceneThatASolverCannotDoCountsAgainstIt) {
  const double levels[] = {0.1};
  const auto found = performance_profiles(
      {scene({timed("a", 1, 0.01), timed("b", 2, 0.01)}), scene({timed("b", 1, 0.01)})}, "e",
      levels);
  EXPECT_EQ(found[0].share(1e9), 0.5);
  EXPECT_EQ(found[1].share(2), 1);
}

}  // namespace
}  // namespace taut::profile_test
