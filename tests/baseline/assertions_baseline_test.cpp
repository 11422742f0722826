// Verdicts of assertions from the findings of truths.
#include "experiments/baseline/assertions_baseline.hpp"

#include <gtest/gtest.h>

namespace taut::assertions_baseline_test {
namespace {

std::vector<JudgedAssertion> judged(TruthVerdict of_three_sweeps) {
  static std::vector<Finding> fine, changed;
  const auto finding = [](TruthVerdict verdict) {
    return Finding{
        "jakobsen:iterations=3", "largest acceleration", "1", 0.06, 0.06, 0.01, 0, verdict, ""};
  };
  fine = {finding(TruthVerdict::passed)};
  changed = {finding(TruthVerdict::passed), finding(of_three_sweeps)};
  return judge_assertions(
      [](std::string_view truth) { return truth == "three-sweeps" ? &changed : &fine; });
}

TEST(AssertionsBaseline, HasEveryAssertionWithVerdictAndFigure) {
  const auto assertions = judged(TruthVerdict::passed);
  ASSERT_EQ(assertions.size(), vasilovici_assertions().size());
  for (std::size_t i = 0; i < assertions.size(); ++i) {
    EXPECT_EQ(assertions[i].verdict, to_string(vasilovici_assertions()[i].verdict));
    EXPECT_EQ(assertions[i].figure.empty(), vasilovici_assertions()[i].truth.empty())
        << assertions[i].assertion;
  }
}

TEST(AssertionsBaseline, ABrokenTruthOverturnsItsAssertionAlone) {
  const auto before = judged(TruthVerdict::passed), now = judged(TruthVerdict::broken),
             deviating = judged(TruthVerdict::deviates);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const bool its = now[i].assertion.starts_with("three sweeps suffice");
    EXPECT_EQ(now[i].verdict, its ? "overturned" : before[i].verdict) << now[i].assertion;
    EXPECT_EQ(deviating[i].verdict, before[i].verdict) << now[i].assertion;
  }
}

}  // namespace
}  // namespace taut::assertions_baseline_test
