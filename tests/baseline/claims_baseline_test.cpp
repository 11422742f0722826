// Verdicts of claims: from the findings of truths, and against those that were kept.
#include "experiments/baseline/claims_baseline.hpp"

#include <gtest/gtest.h>

#include "core/model/input_error.hpp"
#include "experiments/system/files.hpp"

namespace taut {
namespace {

std::vector<JudgedClaim> judged(TruthVerdict of_three_sweeps) {
  static std::vector<Finding> fine, changed;
  const auto finding = [](TruthVerdict verdict) {
    return Finding{
        "jakobsen:iterations=3", "largest acceleration", "1", 0.06, 0.06, 0.01, 0, verdict, ""};
  };
  fine = {finding(TruthVerdict::passed)};
  changed = {finding(TruthVerdict::passed), finding(of_three_sweeps)};
  return judge_claims(
      [](std::string_view truth) { return truth == "three-sweeps" ? &changed : &fine; });
}

TEST(ClaimsBaseline, HasEveryClaimWithVerdictAndFigure) {
  const auto claims = judged(TruthVerdict::passed);
  ASSERT_EQ(claims.size(), vasilovici_claims().size());
  for (std::size_t i = 0; i < claims.size(); ++i) {
    EXPECT_EQ(claims[i].verdict, to_string(vasilovici_claims()[i].verdict));
    EXPECT_EQ(claims[i].figure.empty(), vasilovici_claims()[i].truth.empty()) << claims[i].claim;
  }
  EXPECT_TRUE(compare_claims(claims, claims).empty());
}

TEST(ClaimsBaseline, ABrokenTruthOverturnsItsClaimAlone) {
  const auto before = judged(TruthVerdict::passed), now = judged(TruthVerdict::broken);
  const auto changes = compare_claims(before, now);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_NE(changes[0].find("three sweeps suffice"), std::string::npos) << changes[0];
  EXPECT_NE(changes[0].find("'holds under conditions' -> 'overturned'"), std::string::npos);
  EXPECT_TRUE(compare_claims(before, judged(TruthVerdict::deviates)).empty());
}

TEST(ClaimsBaseline, AVerdictThatIsWrittenOtherwiseIsAChange) {
  const auto now = judged(TruthVerdict::passed);
  for (std::size_t i = 0; i < now.size(); ++i) {
    auto before = now;
    before[i].verdict = before[i].verdict == "holds" ? "does not hold" : "holds";
    EXPECT_EQ(compare_claims(before, now).size(), 1u) << now[i].claim;
    before.erase(before.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_EQ(compare_claims(before, now).size(), 1u) << "new: " << now[i].claim;
    EXPECT_EQ(compare_claims(now, before).size(), 1u) << "gone: " << now[i].claim;
  }
}

TEST(ClaimsBaseline, IsReadBackAndDamageIsNamedByLine) {
  const Scratch scratch;
  const auto claims = judged(TruthVerdict::passed);
  const auto file = scratch.path() / "claims.jsonl";
  write_file(file, to_json_lines(claims));
  EXPECT_EQ(read_claims(file), claims);
  write_file(file, to_json_lines(claims) + "{}\n");
  try {
    read_claims(file);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.diagnostics().front().line, static_cast<int>(claims.size()) + 1);
  }
}

}  // namespace
}  // namespace taut
