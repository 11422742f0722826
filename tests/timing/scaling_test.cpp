// Growth of cost with size, on costs that are formulas.
#include "experiments/timing/scaling.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace taut::scaling_test {
namespace {

std::vector<Case> squares(std::initializer_list<int> sides) {
  std::vector<Case> cases;
  CaseMaker maker;
  for (const char* solver : {"jakobsen", "xpbd"})
    for (const int side : sides) {
      const std::string n = std::to_string(side);
      cases.push_back(maker.make({"hang", {"cloth.grid=[" + n + "," + n + "]"}, solver}));
    }
  return cases;
}

/// Takes n^1.5 seconds, of which every sample is a thousandth.
Measured measured(const Case& one, double) {
  const double n = one.scene->mesh.size(), seconds = std::pow(n, 1.5);
  Measured m{{describe(*one.scene, one.choice), {}}, seconds};
  m.benched.record.step_cost = {{"verlet", 1, 1, static_cast<std::size_t>(100 * n), false}};
  m.benched.timing.samples = std::vector<double>(4, seconds / 1000);
  m.benched.timing.wall = std::vector<double>(4, 1.0);  // the machine's load, not the solver's cost
  return m;
}

TEST(Scaling, TheExponentsOfEverySettingAreFound) {
  const auto lines = measure_scaling(squares({8, 4, 16}), 1e9, measured);
  ASSERT_EQ(lines.size(), 2u);
  for (const ScalingLine& line : lines) {
    EXPECT_EQ(line.cases.front().record.vertices, 16);  // by rising size
    EXPECT_NEAR(line.cpu->exponent, 1.5, 1e-9);
    EXPECT_NEAR(line.memory->exponent, 1, 1e-9);
    EXPECT_TRUE(line.skipped.empty());
  }
}

TEST(Scaling, WhatWouldTakeTooLongIsSkippedAndSaid) {
  const auto lines = measure_scaling(squares({4, 8, 16, 32}), 5000, measured);
  EXPECT_EQ(lines[0].cases.size(), 3u);  // 256 vertices take 4096 s
  ASSERT_EQ(lines[0].skipped.size(), 1u);
  EXPECT_NE(lines[0].skipped[0].find("1024 vertices"), std::string::npos);
}

TEST(Scaling, ACaseIsExpectedToTakeWhatTheOneBeforeTookInProportionToItsSize) {
  std::vector<double> expected;
  measure_scaling(squares({4, 8}), 1e9, [&](const Case& one, double seconds) {
    expected.push_back(seconds);
    return measured(one, seconds);
  });
  EXPECT_EQ(expected, (std::vector<double>{0, 4 * std::pow(16, 1.5), 0, 4 * std::pow(16, 1.5)}));
}

TEST(Scaling, TwoSizesAreNoExponent) {
  EXPECT_FALSE(measure_scaling(squares({4, 8}), 1e9, measured)[0].cpu);
}

}  // namespace
}  // namespace taut::scaling_test
