// The recommended setting, and its certainty.
#include "experiments/timing/recommendation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace taut::recommendation_test {
namespace {

/// Finalist whose samples are `cost` [CPU s per step of 1 s] with a ripple of one per cent.
BenchedCase finalist(const std::string& solver, double cost, double error) {
  BenchedCase c;
  c.record.solver = solver;
  c.record.spec.solver = solver;
  c.record.dt = 1;
  c.record.values["e"] = error;
  for (int i = 0; i < 16; ++i) c.timing.samples.push_back(cost * (1 + 0.01 * (i * 7 % 5 - 2)));
  return c;
}

SceneBench bench(std::vector<BenchedCase> cases, double noise = 0.01) {
  return {"scene", {1 - noise, 1, 1 + noise}, std::move(cases), true, std::vector<Limit>{}};
}

/// Rows of the printed table.
std::string rows(const Recommendation& found, const SceneBench& bench) {
  Table table = recommendations("e");
  add(table, found, bench, "e");
  std::string all;
  for (const auto& row : table.rows)
    for (std::size_t i = 1; i < row.size(); ++i)
      all += text(row[i], table.columns[i]) + (i + 1 < row.size() ? ", " : "\n");
  return all;
}

TEST(Recommendation, TheCheapestWinsAndTheRivalIsAnotherSolver) {
  const SceneBench b = bench({finalist("a", 2, 0.009), finalist("a", 1, 0.01),
                              finalist("b", 3, 0.001), finalist("c", 0.1, 0.02)});
  const Recommendation found = recommend(b, {0.01, {}}, "e", 0.05);
  EXPECT_EQ(found.best, 1u);
  EXPECT_EQ(found.runner_up, 2u);
  EXPECT_NEAR(found.ratio->mid, 3, 1e-9);
  EXPECT_EQ(found.certainty, Certainty::clear);
}

// A difference of 0.1 % is below the tolerance, however narrow the interval: no one should choose
// by it.
TEST(Recommendation, LessThanTheToleranceIsNoDifferenceAndSaidSo) {
  const auto said = [](double cost, double tolerance) {
    const SceneBench b = bench({finalist("jakobsen", 1, 0.01), finalist("bullet", cost, 0.01)});
    const Recommendation found = recommend(b, {0.01, {}}, "e", tolerance);
    EXPECT_EQ(found.certainty == Certainty::none, cost < 1 + tolerance) << cost;
    return "; " + verdict(found, b);
  };
  for (const double cost : {1.0, 1.001, 1.04})
    EXPECT_TRUE(said(cost, 0.05).ends_with("; costs the same as bullet within 5 %")) << cost;
  EXPECT_TRUE(said(1.06, 0.05).ends_with("; clearly cheaper than bullet"));
  EXPECT_TRUE(said(1.06, 0.1).ends_with("; costs the same as bullet within 10 %"));
  EXPECT_TRUE(said(1.001, 0).ends_with("; too noisy to compare with bullet"));
}

// Equal medians do not prove equality: in half of the blocks one setting costs a fifth more.
TEST(Recommendation, NothingIsToldFromAWideIntervalOrUnderNoise) {
  BenchedCase wide = finalist("bullet", 1, 0.01);
  for (std::size_t i = 0; i < wide.timing.samples.size(); ++i)
    wide.timing.samples[i] *= i / 2 % 2 == 0 ? 1.2 : 1 / 1.18;
  const auto said = [](const SceneBench& b) {
    return "; " + verdict(recommend(b, {0.01, {}}, "e"), b);
  };
  EXPECT_TRUE(said(bench({finalist("jakobsen", 1, 0.01), wide}))
                  .ends_with("; not measurably cheaper than bullet"));
  EXPECT_TRUE(said(bench({finalist("jakobsen", 1, 0.01), finalist("bullet", 1.2, 0.01)}, 0.3))
                  .ends_with("; too noisy to compare with bullet"));
}

TEST(Recommendation, ANoisyMachineIsNeverClear) {
  const Recommendation found = recommend(
      bench({finalist("a", 1, 0.01), finalist("b", 3, 0.01)}, 0.3), {0.01, {}}, "e", 0.05);
  EXPECT_EQ(found.certainty, Certainty::likely);
}

TEST(Recommendation, ABudgetBuysTheSmallestError) {
  const SceneBench b =
      bench({finalist("a", 1, 0.01), finalist("b", 2, 0.001), finalist("c", 9, 0)});
  EXPECT_EQ(recommend(b, {{}, 4}, "e", 0.05).best, 1u);
  EXPECT_EQ(recommend(b, {{}, 4}, "e", 0.05).certainty, Certainty::clear);
  EXPECT_EQ(recommend(b, {{}, 2.0001}, "e", 0.05).certainty, Certainty::likely);
}

TEST(Recommendation, NobodyIsRecommendedForWhatNobodyReaches) {
  EXPECT_FALSE(recommend(bench({finalist("a", 1, 0.01)}), {1e-9, {}}, "e", 0.05).best);
  EXPECT_EQ(recommend(bench({finalist("a", 1, 0.01)}), {1, {}}, "e", 0.05).certainty,
            Certainty::unopposed);
}

TEST(Recommendation, EverySolverIsNamedWithCostOrNearestError) {
  SceneBench b = bench({finalist("jakobsen", 1, 0.01), finalist("bullet", 3, 0.001),
                        finalist("xpbd", 0.1, 0.02), finalist("mass-spring", 0.01, 0.001)});
  // a setting that failed fast is never ranked
  b.cases[3].record.status.kind = Status::Kind::exploded;
  const Recommendation found = recommend(b, {0.01, {}}, "e");
  EXPECT_EQ(found.best, 0u);
  EXPECT_EQ(found.solvers[1].at, 1u);
  EXPECT_NEAR(found.solvers[1].times->mid, 3, 1e-9);
  EXPECT_EQ(found.solvers[2].at, std::nullopt);
  const std::string said = rows(found, b);
  for (const char* part :
       {"e <= 0.01, jakobsen, jakobsen, 0.01, 16.7", ", clearly cheaper than bullet\n",
        "e <= 0.01, bullet, bullet, 0.001, 50 ",
        "xpbd, , -, -, -, not by the settings tried; at best 0.02 (xpbd)",
        "mass-spring, , -, -, -, not by the settings tried; exploded"})
    EXPECT_NE(said.find(part), std::string::npos) << part << " in\n" << said;
  EXPECT_EQ(rows(recommend(b, {1e-9, {}}, "e"), b).find("cheaper"), std::string::npos);
}

/// Case whose samples are all equal.
BenchedCase still(const std::string& solver, double cost, double error) {
  BenchedCase c = finalist(solver, cost, error);
  c.record.solver = solver.substr(0, solver.find(':'));
  c.timing.samples.assign(8, cost);
  return c;
}

// 20 ms for a step of 1 s are 20 ms per simulated second. Two settings of one solver share a line.
TEST(Recommendation, ReadsLineByLineAsThis) {
  SceneBench b = bench({still("bullet", 0.06, 0.001), still("jakobsen:iterations=4", 0.02, 0.01),
                        still("xpbd", 0.002, 0.03), still("xpbd:substeps=1024", 0.004, 0.02),
                        still("bullet:iterations=2", 0.05, 0.01)});
  EXPECT_EQ(rows(recommend(b, {0.01, {}}, "e"), b),
            "e <= 0.01, jakobsen, jakobsen:iterations=4, 0.01, 0.333 (0.333 to 0.333) ms a frame, "
            "-, clearly cheaper than bullet\n"
            "e <= 0.01, bullet, bullet:iterations=2, 0.01, 0.833 (0.833 to 0.833) ms a frame, "
            "2.5 (2.5 to 2.5), \n"
            "e <= 0.01, xpbd, , -, -, -, not by the settings tried; at best 0.02 "
            "(xpbd:substeps=1024)\n");
  b.cases[3].record.params = {{"substeps", "1024"}, {"iterations", "128"}};
  const std::string all = rows(recommend(b, {{}, 0.0006}, "e"), b);
  EXPECT_TRUE(all.starts_with("least e within 0.01 ms a frame of 1/60 s, bullet, , -,")) << all;
  EXPECT_NE(
      all.find("jakobsen, , -, -, -, not by the settings tried; the cheapest costs 0.33\u00A0ms "
               "a frame (jakobsen:iterations=4)"),
      std::string::npos)
      << all;
  EXPECT_NE(
      all.find("xpbd, , -, -, -, never, to the end of its accuracy parameters; the cheapest costs "
               "0.033\u00A0ms a frame (xpbd)"),
      std::string::npos)
      << "of a budget the cheapest is nearest\n"
      << all;
  EXPECT_NE(
      all.find("bullet, , -, -, -, not by the settings tried; the cheapest costs 0.83\u00A0ms "
               "a frame (bullet:iterations=2)"),
      std::string::npos)
      << all;
}

TEST(Recommendation, TheWordsSayOfWhatItIsSure) {
  const auto said = [](const SceneBench& b, const Target& target) {
    return "; " + verdict(recommend(b, target, "e", 0.05), b);
  };
  const BenchedCase a = finalist("jakobsen", 1, 0.01), b = finalist("bullet", 1, 0.02);
  EXPECT_TRUE(said(bench({a, b}), {{}, 4}).ends_with("; clearly within the budget"));
  EXPECT_TRUE(said(bench({a, b}), {{}, 1.0001}).ends_with("; likely within the budget"));
  EXPECT_TRUE(said(bench({a, b}), {0.02, {}}).ends_with("; costs the same as bullet within 5 %"));
  const BenchedCase slow = finalist("bullet", 3, 0.01), slower = finalist("jakobsen", 4, 0.01);
  EXPECT_TRUE(said(bench({a, slow}), {0.01, {}}).ends_with("; clearly cheaper than bullet"));
  EXPECT_TRUE(said(bench({a, slow}, 0.3), {0.01, {}}).ends_with("; likely cheaper than bullet"));
  EXPECT_TRUE(
      said(bench({a, slower}), {0.01, {}}).ends_with("; clearly cheaper than the next setting"));
  EXPECT_TRUE(said(bench({a}), {0.01, {}}).ends_with("; nothing else timed reaches it"));
}

/// Times of a case of cost 1 in `rounds` rounds on a noisy machine: every sample varies by about
/// `sigma`, and one in ten is interrupted and takes up to twice as long.
std::vector<double> session(int rounds, double sigma, std::mt19937_64& random) {
  const auto uniform = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  std::vector<double> samples;
  for (int i = 0; i < 2 * rounds; ++i) {
    double normal = -6;  // the sum of twelve uniform numbers has variance 1
    for (int k = 0; k < 12; ++k) normal += uniform();
    samples.push_back(std::exp(sigma * normal) * (uniform() < 0.1 ? 1 + uniform() : 1));
  }
  return samples;
}

TEST(Recommendation, ASecondSessionLiesInsideTheInterval) {
  std::mt19937_64 random(1);
  // the fewest rounds that advise accepts, and the number that it aims at
  for (const int rounds : {2, 8})
    for (const double sigma : {0.01, 0.1}) {
      constexpr int kRuns = 500;
      int inside = 0, inside_its_own = 0;
      for (int run = 0; run < kRuns; ++run) {
        SceneBench b = bench({finalist("a", 1, 0.01)});
        b.cases[0].timing.samples = session(rounds, sigma, random);
        b.control = interleaved_ratio(b.cases[0].timing.samples, session(rounds, sigma, random));
        const double again = median(session(rounds, sigma, random));
        inside += cost_expected_again(b, 0).contains(again);
        inside_its_own += b.cases[0].cost().contains(again);
      }
      EXPECT_GE(inside, 0.9 * kRuns) << rounds << " rounds, " << sigma;
      EXPECT_LT(inside_its_own, 0.9 * kRuns) << "the control is not needed: " << rounds;
    }
}

TEST(Recommendation, EverySolverSendsItsBestToTheFinal) {
  const std::vector<Candidate> tried{{"a", "a1", {0.9, 1, 99}, 0.01},
                                     {"a", "a2", {0.2, 2, 20}, 0.01},
                                     {"a", "a3", {0.1, 3, 10}, 0.01},
                                     {"b", "b1", {0.01, 9, 9}, 0.01},
                                     {"c", "c1", {0.01, 1, 1}, 0.5}};
  EXPECT_EQ(finalists(tried, {0.01, {}}, 3), (std::vector<std::size_t>{0, 3, 1}));
}

}  // namespace
}  // namespace taut::recommendation_test
