// What Vasilovici's report claims: every verdict that can be held is held by a truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "experiments/truths/truth.hpp"
#include "experiments/truths/vasilovici/claims.hpp"

namespace taut {
namespace {

TEST(VasiloviciClaims, EachIsHeldByATruthUnlessItCannotBeTested) {
  std::map<ClaimVerdict, int> verdicts;
  for (const VasiloviciClaim& claim : vasilovici_claims()) {
    ++verdicts[claim.verdict];
    EXPECT_FALSE(claim.because.empty()) << claim.claim;
    EXPECT_EQ(claim.truth.empty(), claim.verdict == ClaimVerdict::cannot_be_tested) << claim.claim;
    const bool known =
        std::ranges::any_of(truths(), [&](const TruthEntry* t) { return t->name == claim.truth; });
    EXPECT_EQ(known, !claim.truth.empty()) << claim.truth;
  }
  EXPECT_EQ(verdicts.size(), 4u) << "a report that is right, or wrong, in everything";
}

TEST(VasiloviciClaims, TheTruthsBehindBoxesAndOctreesHold) {
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
