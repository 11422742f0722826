// What Vasilovici's report asserts: every verdict that can be held is held by a truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "experiments/truths/truth.hpp"
#include "experiments/truths/vasilovici/assertions.hpp"

namespace taut::vasilovici_assertions_test {
namespace {

TEST(VasiloviciAssertions, EachIsHeldByATruthUnlessItCannotBeTested) {
  std::map<AssertionVerdict, int> verdicts;
  for (const VasiloviciAssertion& assertion : vasilovici_assertions()) {
    ++verdicts[assertion.verdict];
    EXPECT_FALSE(assertion.because.empty()) << assertion.assertion;
    EXPECT_EQ(assertion.truth.empty(), assertion.verdict == AssertionVerdict::cannot_be_tested)
        << assertion.assertion;
    const bool known = std::ranges::any_of(
        truths(), [&](const TruthEntry* t) { return t->name == assertion.truth; });
    EXPECT_EQ(known, !assertion.truth.empty()) << assertion.truth;
  }
  EXPECT_EQ(verdicts.size(), 4u) << "a report that is right, or wrong, in everything";
}

TEST(VasiloviciAssertions, TheTruthsBehindBoxesAndOctreesHold) {
  for (const TruthEntry* truth : truths()) {
    if (truth->section != 8 || truth->row < 6 || truth->name == "octree-crossings") continue;
    Findings findings({"jakobsen", "closed form"});
    truth->check(findings);
    EXPECT_GE(findings.all().size(), 1u) << truth->name;
    for (const Finding& finding : findings.all())
      EXPECT_EQ(finding.verdict, TruthVerdict::passed)
          << truth->name << ", " << finding.quantity << ": " << finding.measured;
  }
}

}  // namespace
}  // namespace taut::vasilovici_assertions_test
