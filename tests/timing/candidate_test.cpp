// Candidates for a target: which is chosen and which is not.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "experiments/timing/study_bench.hpp"

namespace taut::candidate_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Both ends of the interval fall as the cost rises, so that a search that mistakes an end for the
/// cost fails.
Candidate candidate(const char* solver, double cost, double error, const char* failure = "") {
  return {solver, solver, {0.01 / cost, cost, 100 / cost}, error, failure};
}

const std::vector<Candidate> kAll{
    candidate("a", 1, 0.2),   candidate("a", 2, 0.02),
    candidate("a", 4, 0.05),  // dominated by the candidate before
    candidate("b", 3, 0.02),  // same error at a higher cost
    candidate("b", 8, 0.001), candidate("c", 0.1, 0.0, "exploded (energy)"),  // failed fast
    candidate("c", 0.2, kNaN)};

Target within(double error) { return {error, {}}; }
Target budget(double cost) { return {{}, cost}; }

TEST(Candidates, AFastFailureNeverRanksFastest) {
  EXPECT_EQ(best_for(within(1), kAll), 0u);
  EXPECT_EQ(best_for(within(1), kAll, "c"), std::nullopt);
  EXPECT_EQ(best_for(budget(0.5), kAll), std::nullopt);
}

TEST(Candidates, ALevelIsReachedByTheCheapestThatMeetsIt) {
  EXPECT_EQ(best_for(within(0.02), kAll, "a"), 1u);
  EXPECT_EQ(best_for(within(0.02), kAll, "b"), 3u);
  EXPECT_EQ(best_for(within(0.01), kAll, "a"), std::nullopt);  // never reached
}

TEST(Candidates, ABudgetBuysTheSmallestError) {
  EXPECT_EQ(best_for(budget(3.5), kAll), 1u);  // b's equal error costs more
  EXPECT_EQ(best_for(budget(100), kAll, "b"), 4u);
}

TEST(Candidates, AnExactZeroMeetsAnErrorOfZero) {
  const std::vector<Candidate> two{candidate("a", 1, 0.1), candidate("a", 2, 0.0)};
  EXPECT_EQ(best_for(within(0), two), 1u);
}

}  // namespace
}  // namespace taut::candidate_test
