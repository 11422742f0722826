// Assertions of publications: every verdict that a truth can check is checked by a truth.
#include "experiments/truths/assertions/assertions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>

#include "core/io/text_file.hpp"
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

// The quantities that a truth measures are known only after it ran, as in `taut verify`. This tests
// that its source names the constant with the quoted words.
TEST(Assertions, QuoteQuantitiesThatTheirTruthsMeasure) {
  const std::filesystem::path folder =
      std::filesystem::path(TAUT_SOURCE_DIR) / "experiments/truths";
  const std::string words = read_text(folder / "quoted.hpp");
  std::string sources;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".cpp") sources += read_text(entry.path());
  /// The constant in quoted.hpp with this text: "quoted::kName"; "" if there is none.
  const auto constant = [&](std::string_view text) -> std::string {
    const auto at = words.find('"' + std::string(text) + "\";");
    const auto name = words.rfind("* k", at);
    if (at == words.npos || name == words.npos) return "";
    return "quoted::" + words.substr(name + 2, words.find(" ", name + 2) - name - 2);
  };
  /// The definition of a truth, up to the next one.
  const auto definition = [&](std::string_view truth) {
    std::string id(truth);
    std::ranges::replace(id, '-', '_');
    const std::string start = "TAUT_TRUTH(";
    const auto at = sources.find(start + id + ",");
    return at == sources.npos ? "" : sources.substr(at, sources.find(start, at + 1) - at);
  };
  std::size_t quoted = 0;
  for (const Assertion& assertion : assertions()) {
    if (assertion.figure.empty()) continue;
    ++quoted;
    const std::string name = constant(assertion.figure);
    ASSERT_NE(name, "") << "not in quoted.hpp: " << assertion.figure;
    EXPECT_NE(definition(assertion.truth).find(name), std::string::npos)
        << assertion.truth << " does not measure " << name;
  }
  std::size_t constants = 0;
  for (auto at = words.find("* k"); at != words.npos; at = words.find("* k", at + 1)) ++constants;
  EXPECT_EQ(quoted, constants) << "a constant that no assertion quotes";
  EXPECT_EQ(constant("no such words"), "");
  EXPECT_EQ(definition("no-such-truth"), "");
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
