// Verdicts on assertions, from the findings of truths.
#include <gtest/gtest.h>

#include <map>

#include "core/model/solver.hpp"
#include "experiments/truths/assertions/judged.hpp"

namespace taut::judged_assertions_test {
namespace {

/// Each assertion has a passed finding of the quantity and the solver that it quotes, plus one more
/// finding of that truth.
std::vector<JudgedAssertion> judged(TruthVerdict of_three_sweeps) {
  std::map<std::string, std::vector<Finding>, std::less<>> findings;
  const auto finding = [](std::string_view quantity, TruthVerdict verdict,
                          std::string_view solver = "") {
    return Finding{(solver.empty() ? "jakobsen" : std::string(solver)) + ":iterations=3",
                   std::string(quantity),
                   "1",
                   0.06,
                   0.06,
                   0.01,
                   0,
                   verdict,
                   ""};
  };
  for (const Assertion& one : assertions())
    findings[std::string(one.truth)].push_back(
        finding(one.figure, TruthVerdict::passed, one.solver));
  findings["three-sweeps"].push_back(finding("", of_three_sweeps));
  return judge_assertions([&](std::string_view truth) { return &findings.find(truth)->second; });
}

TEST(AssertionsBaseline, HasEveryAssertionWithVerdictAndFigure) {
  const auto all = judged(TruthVerdict::passed);
  ASSERT_EQ(all.size(), assertions().size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].verdict, assertions()[i].verdict);
    EXPECT_EQ(all[i].source, assertions()[i].source);
    EXPECT_EQ(all[i].figure.empty(), assertions()[i].truth.empty()) << all[i].assertion;
  }
}

TEST(AssertionsBaseline, QuoteTheSolverThatTheyAreAbout) {
  int of_one_solver = 0;
  for (const Assertion& one : assertions()) {
    if (one.solver.empty()) continue;
    ++of_one_solver;
    EXPECT_EQ(find_solver(one.solver).name, one.solver);
    const auto finding = [&](std::string_view subject, double measured) {
      return Finding{std::string(subject),
                     std::string(one.figure),
                     "1",
                     measured,
                     1,
                     0.5,
                     0,
                     TruthVerdict::passed,
                     ""};
    };
    const std::vector<Finding> findings{finding("bullet", 0.75),
                                        finding(std::string(one.solver) + ":substeps=2", 1.25)};
    for (const JudgedAssertion& now : judge_assertions(
             [&](std::string_view truth) { return truth == one.truth ? &findings : nullptr; }))
      if (now.source == one.source && now.assertion == one.assertion) {
        EXPECT_TRUE(now.figure.starts_with(std::string(one.solver) + ": ")) << now.figure;
        EXPECT_TRUE(now.figure.ends_with(" 1.25 (1 +- 0.5)")) << now.figure;
      }
  }
  EXPECT_GT(of_one_solver, 0);
}

TEST(AssertionsBaseline, ABrokenTruthOverturnsItsAssertionAlone) {
  const auto before = judged(TruthVerdict::passed), now = judged(TruthVerdict::broken),
             deviating = judged(TruthVerdict::deviates);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const bool its = now[i].assertion.starts_with("three sweeps suffice");
    EXPECT_EQ(now[i].verdict, its ? AssertionVerdict::overturned : before[i].verdict)
        << now[i].assertion;
    EXPECT_EQ(deviating[i].verdict, before[i].verdict) << now[i].assertion;
  }
}

}  // namespace
}  // namespace taut::judged_assertions_test
