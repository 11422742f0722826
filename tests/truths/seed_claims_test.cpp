// What Vasilovici's report claims: every verdict that can be held is held by a truth.
#include "experiments/truths/seed_claims.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "experiments/truths/truth.hpp"

namespace taut {
namespace {

TEST(SeedClaims, EachIsHeldByATruthUnlessItCannotBeTested) {
  std::map<SeedVerdict, int> verdicts;
  for (const SeedClaim& claim : seed_claims()) {
    ++verdicts[claim.verdict];
    EXPECT_FALSE(claim.because.empty()) << claim.claim;
    EXPECT_EQ(claim.truth.empty(), claim.verdict == SeedVerdict::cannot_be_tested) << claim.claim;
    const bool known =
        std::ranges::any_of(truths(), [&](const TruthEntry* t) { return t->name == claim.truth; });
    EXPECT_EQ(known, !claim.truth.empty()) << claim.truth;
  }
  EXPECT_EQ(verdicts.size(), 4u) << "a report that is right, or wrong, in everything";
}

TEST(SeedClaims, TheTruthsBehindBoxesAndOctreesHold) {
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
}  // namespace taut
