// Verdicts of assertions: from the findings of truths, and against those that were kept.
#include "experiments/baseline/assertions_baseline.hpp"

#include <gtest/gtest.h>

#include "core/model/input_error.hpp"
#include "experiments/system/files.hpp"

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
  EXPECT_TRUE(compare_assertions(assertions, assertions).empty());
}

TEST(AssertionsBaseline, ABrokenTruthOverturnsItsAssertionAlone) {
  const auto before = judged(TruthVerdict::passed), now = judged(TruthVerdict::broken);
  const auto changes = compare_assertions(before, now);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_NE(changes[0].find("three sweeps suffice"), std::string::npos) << changes[0];
  EXPECT_NE(changes[0].find("'holds under conditions' -> 'overturned'"), std::string::npos);
  EXPECT_TRUE(compare_assertions(before, judged(TruthVerdict::deviates)).empty());
}

TEST(AssertionsBaseline, AVerdictThatIsWrittenOtherwiseIsAChange) {
  const auto now = judged(TruthVerdict::passed);
  for (std::size_t i = 0; i < now.size(); ++i) {
    auto before = now;
    before[i].verdict = before[i].verdict == "holds" ? "does not hold" : "holds";
    EXPECT_EQ(compare_assertions(before, now).size(), 1u) << now[i].assertion;
    before.erase(before.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_EQ(compare_assertions(before, now).size(), 1u) << "new: " << now[i].assertion;
    EXPECT_EQ(compare_assertions(now, before).size(), 1u) << "gone: " << now[i].assertion;
  }
}

TEST(AssertionsBaseline, IsReadBackAndDamageIsNamedByLine) {
  const Scratch scratch;
  const auto assertions = judged(TruthVerdict::passed);
  const auto file = scratch.path() / "assertions.jsonl";
  write_file(file, to_json_lines(assertions));
  EXPECT_EQ(read_assertions(file), assertions);
  write_file(file, to_json_lines(assertions) + "{}\n");
  try {
    read_assertions(file);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.diagnostics().front().line, static_cast<int>(assertions.size()) + 1);
  }
}

}  // namespace
}  // namespace taut::assertions_baseline_test
