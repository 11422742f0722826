// Assertions of publications: every verdict that a truth can check is checked by a truth.
#include "experiments/truths/assertions/assertions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "experiments/truths/truth.hpp"

namespace taut::assertions_test {
namespace {

TEST(Assertions, EachIsHeldByATruthUnlessItCannotBeTested) {
  std::map<AssertionVerdict, int> verdicts;
  for (const Assertion& assertion : assertions()) {
    ++verdicts[assertion.verdict];
    EXPECT_FALSE(assertion.because.empty()) << assertion.assertion;
    EXPECT_EQ(assertion.truth.empty(), assertion.verdict == AssertionVerdict::cannot_be_tested)
        << assertion.assertion;
    const bool known = std::ranges::any_of(
        truths(), [&](const TruthEntry* t) { return t->name == assertion.truth; });
    EXPECT_EQ(known, !assertion.truth.empty()) << assertion.truth;
  }
  EXPECT_EQ(verdicts.size(), 4u) << "publications that are right, or wrong, in everything";
}

#ifdef TAUT_SANITIZED  // without sanitizers `taut verify` checks them
TEST(Assertions, TheTruthsBehindBoxesAndOctreesHold) {
  for (const TruthEntry* truth : truths()) {
    if (truth->section != 8 || truth->row < 6 || truth->row > 16 ||
        truth->name == "octree-crossings")
      continue;
    Findings findings({"jakobsen", "closed form"});
    truth->check(findings);
    EXPECT_GE(findings.all().size(), 1u) << truth->name;
    for (const Finding& finding : findings.all())
      EXPECT_EQ(finding.verdict, TruthVerdict::passed)
          << truth->name << ", " << finding.quantity << ": " << finding.measured;
  }
}
#endif

}  // namespace
}  // namespace taut::assertions_test
