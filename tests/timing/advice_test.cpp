// Who is recommended, and how sure that is.
#include "experiments/timing/advice.hpp"

#include <gtest/gtest.h>

namespace taut {
namespace {

/// A finalist whose samples are `cost` [CPU s per step of 1 s] with a ripple of one per cent.
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
  return {"scene", {1 - noise, 1, 1 + noise}, std::move(cases)};
}

TEST(Advice, TheCheapestWithinTheErrorWinsAndTheRivalIsAnotherSolver) {
  const SceneBench b = bench({finalist("a", 2, 0.009), finalist("a", 1, 0.01),
                              finalist("b", 3, 0.001), finalist("c", 0.1, 0.02)});
  const Advice advice = judge_finalists(b, {0.01, {}}, "e", 0.05);
  EXPECT_EQ(advice.best, 1u);
  EXPECT_EQ(advice.runner_up, 2u);
  EXPECT_NEAR(advice.ratio->mid, 3, 1e-9);
  EXPECT_EQ(advice.certainty, Certainty::clear);
}

TEST(Advice, EqualCostsAreATie) {
  const Advice advice = judge_finalists(bench({finalist("a", 1, 0.01), finalist("b", 1, 0.01)}),
                                        {0.01, {}}, "e", 0.05);
  EXPECT_EQ(advice.certainty, Certainty::a_tie);
}

TEST(Advice, ANoisyMachineIsNeverClear) {
  const Advice advice = judge_finalists(
      bench({finalist("a", 1, 0.01), finalist("b", 3, 0.01)}, 0.3), {0.01, {}}, "e", 0.05);
  EXPECT_EQ(advice.certainty, Certainty::likely);
}

TEST(Advice, ABudgetBuysTheSmallestErrorAndIsClearOnlyIfTheWholeIntervalFits) {
  const SceneBench b =
      bench({finalist("a", 1, 0.01), finalist("b", 2, 0.001), finalist("c", 9, 0)});
  EXPECT_EQ(judge_finalists(b, {{}, 4}, "e", 0.05).best, 1u);
  EXPECT_EQ(judge_finalists(b, {{}, 4}, "e", 0.05).certainty, Certainty::clear);
  EXPECT_EQ(judge_finalists(b, {{}, 2.0001}, "e", 0.05).certainty, Certainty::likely);
}

TEST(Advice, NobodyIsRecommendedForWhatNobodyReaches) {
  EXPECT_FALSE(judge_finalists(bench({finalist("a", 1, 0.01)}), {1e-9, {}}, "e", 0.05).best);
  EXPECT_EQ(judge_finalists(bench({finalist("a", 1, 0.01)}), {1, {}}, "e", 0.05).certainty,
            Certainty::unopposed);
}

TEST(Advice, EverySolverSendsItsBestToTheFinal) {
  const std::vector<Offer> tried{{"a", "a1", {0.9, 1, 99}, 0.01},
                                 {"a", "a2", {0.2, 2, 20}, 0.01},
                                 {"a", "a3", {0.1, 3, 10}, 0.01},
                                 {"b", "b1", {0.01, 9, 9}, 0.01},
                                 {"c", "c1", {0.01, 1, 1}, 0.5}};
  EXPECT_EQ(finalists(tried, {0.01, {}}, 3), (std::vector<std::size_t>{0, 3, 1}));
}

}  // namespace
}  // namespace taut
