// Two sessions of one bench: when they agree, and when they contradict each other.
#include "experiments/timing/agreement.hpp"

#include <gtest/gtest.h>

#include <random>

namespace taut {
namespace {

BenchedCase timed(const std::string& solver, double stretch, const std::vector<double>& samples) {
  BenchedCase c;
  c.record.id = "hang " + solver;
  c.record.scene = "hang", c.record.solver = solver.substr(0, solver.find(':'));
  c.record.dt = 1;
  c.record.spec = {"hang", {}, solver};
  c.record.values["stretch.rms"] = stretch;
  c.timing.samples = samples;
  return c;
}

/// A session on a machine of the given speed: costs 1 and `factor`, noise of 1 %.
BenchSession session(double factor, double speed, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<> noise(0, 0.01);
  std::vector<double> a, b;
  for (int i = 0; i < 20; ++i) {
    a.push_back(speed * (1 + noise(random)));
    b.push_back(speed * factor * (1 + noise(random)));
  }
  return {
      "trade", "", {{"hang", {0.99, 1, 1.01}, {timed("a:k=1", 0.2, a), timed("b:k=1", 0.005, b)}}}};
}

TEST(Agreement, TheSameBuildAgreesThoughTheMachineRunsAtAnotherSpeed) {
  std::size_t overlapping = 0;
  for (unsigned k = 0; k < 50; ++k) {
    const Agreement found =
        agreement(session(3, 1, 2 * k), session(3, 1.7, 2 * k + 1), "stretch.rms", 0.05);
    ASSERT_EQ(found.ratios.size(), 1u);
    EXPECT_EQ(found.contradictions(), 0u);
    overlapping += found.overlapping();
  }
  EXPECT_GE(overlapping, 45u);
}

TEST(Agreement, AnotherCostContradicts) {
  const Agreement found = agreement(session(3, 1, 1), session(3.6, 1, 2), "stretch.rms", 0.05);
  EXPECT_EQ(found.overlapping(), 0u);
  EXPECT_EQ(found.contradictions(), 1u);
}

TEST(Agreement, ANoisySessionContradictsNobody) {
  BenchSession noisy = session(3.6, 1, 2);
  noisy.scenes[0].control = {0.7, 1, 1.3};
  EXPECT_EQ(agreement(session(3, 1, 1), noisy, "stretch.rms", 0.05).contradictions(), 0u);
}

TEST(Agreement, AnotherWinnerContradicts) {
  BenchSession other = session(3, 1, 2);
  other.scenes[0].cases[0].record.values["stretch.rms"] = 0.004;  // now the cheap one reaches 1 %
  const Agreement found = agreement(session(3, 1, 1), other, "stretch.rms", 0.05);
  EXPECT_EQ(found.contradictions(), 2u) << "for 10 % and for 1 %";
}

TEST(Agreement, ScenesInCommonAreNeeded) {
  BenchSession other = session(3, 1, 2);
  other.scenes[0].scene = "flag";
  EXPECT_TRUE(agreement(session(3, 1, 1), other, "stretch.rms", 0.05).ratios.empty());
}

}  // namespace
}  // namespace taut
