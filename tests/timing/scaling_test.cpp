// Growth of cost with size, for costs given by formulas.
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

/// Case that takes n^1.5 seconds, with samples of a thousandth each.
Measured measured(const Case& one, double) {
  const double n = one.scene->mesh.size(), seconds = std::pow(n, 1.5);
  Measured m{{describe(*one.scene, one.choice), {}}, seconds};
  m.benched.record.step_cost = {{"verlet", 1, 1, static_cast<std::size_t>(100 * n), false}};
  m.benched.timing.samples = std::vector<double>(4, seconds / 1000);
  // depends on the machine's load, not on the solver's cost
  m.benched.timing.wall = std::vector<double>(4, 1.0);
  return m;
}

TEST(Scaling, TheExponentsOfEverySettingAreFound) {
  const auto lines = measure_scaling(squares({8, 4, 16}), 1e9, measured);
  ASSERT_EQ(lines.size(), 2u);
  for (const ScalingLine& line : lines) {
    EXPECT_EQ(line.cases.front().record.vertices, 16);  // in order of size
    EXPECT_NEAR(line.cpu->exponent, 1.5, 1e-9);
    EXPECT_NEAR(line.memory->exponent, 1, 1e-9);
    EXPECT_TRUE(line.skipped.empty());
  }
}

TEST(Scaling, WhatWouldTakeTooLongIsSkippedAndSaid) {
  const auto lines = measure_scaling(squares({4, 8, 16, 32}), 5000, measured);
  EXPECT_EQ(lines[0].cases.size(), 3u);  // the size of 256 vertices would take 4096 s
  ASSERT_EQ(lines[0].skipped.size(), 1u);
  EXPECT_EQ(lines[0].skipped[0], "1024 vertices: expected to take 16384 s, allowed 5000 s");
  EXPECT_EQ(measure_scaling(squares({4, 8}), 256, measured)[0].cases.size(), 2u)
      << "as long as is allowed";
}

TEST(Scaling, WhatEndsEarlyDoesNotPromiseTheNextToBeQuick) {
  const auto lines = measure_scaling(squares({8, 12, 40}), 1500, [](const Case& one, double) {
    Measured m = measured(one, 0);
    if (m.benched.record.vertices == 144) m.seconds = 0.1;
    return m;
  });
  EXPECT_EQ(lines[0].cases.size(), 2u);
  EXPECT_EQ(lines[0].skipped.back(), "1600 vertices: expected to take 5689 s, allowed 1500 s");
}

// A failed case is reported and left out of the exponent. Wall time only reflects the machine's
// load.
TEST(Scaling, WhatEndedBadlyIsNoPointOfTheLine) {
  const auto lines = measure_scaling(squares({4, 8, 12, 16, 20}), 1e9, [](const Case& one, double) {
    Measured m = measured(one, 0);
    if (m.benched.record.vertices == 64) m.benched.record.status.kind = Status::Kind::exploded;
    if (m.benched.record.vertices == 144) m.benched.timing.failure = "no clock";
    if (m.benched.record.vertices == 144 || m.benched.record.vertices == 64)
      m.benched.timing.samples.assign(4, 1e6);
    return m;
  });
  EXPECT_EQ(lines[0].skipped,
            (std::vector<std::string>{"64 vertices: exploded", "144 vertices: no clock"}));
  EXPECT_EQ(lines[0].cases.size(), 5u);
  EXPECT_NEAR(lines[0].cpu->exponent, 1.5, 1e-9);
  EXPECT_NEAR(lines[0].wall->exponent, 0, 1e-9);
  EXPECT_EQ(lines[0].setting, "jakobsen");
  EXPECT_EQ(lines[1].setting, "xpbd");
  Record record;
  record.step_cost = {{.pass = "a", .items = 9, .repeats = 7, .bytes = 20}, {.bytes = 3}};
  EXPECT_EQ(plan_bytes(record), 23) << "held once, however often it is gone through";
}

TEST(Scaling, ACaseIsExpectedToTakeTimeByItsSize) {
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
