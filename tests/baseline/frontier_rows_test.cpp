// Frontiers in a baseline: questions from a file, rows from results.
#include <gtest/gtest.h>

#include "core/model/input_error.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/system/files.hpp"
#include "experiments/truths/assertions/judged.hpp"

namespace taut::frontier_rows_test {
namespace {

const std::string kTwo = R"([[frontier]]
scene = "hang"
solver = "jakobsen:iterations=2"
of = "dt"
from = 0.001
to = 0.25
[[frontier]]
scene = "hang"
solver = "mass-spring"
set = ["cloth.grid=[4, 4]", "time.duration=1"]
of = "substeps"
from = 2
to = 64
tolerance = 0.125
)";

class FrontierFiles : public testing::Test {
 protected:
  std::vector<FrontierQuestion> read(const std::string& text) const {
    write_file(scratch_.path() / "frontiers.toml", text);
    return read_frontiers(scratch_.path());
  }
  const Scratch scratch_;
};

TEST_F(FrontierFiles, AreQuestionsInOrder) {
  EXPECT_TRUE(read_frontiers(scratch_.path()).empty());
  const auto questions = read(kTwo);
  ASSERT_EQ(questions.size(), 2u);
  const FrontierQuestion &first = questions[0], &second = questions[1];
  EXPECT_EQ(
      (std::tuple{first.base.scene, first.base.solver, first.of}),
      (std::tuple{std::string("hang"), std::string("jakobsen:iterations=2"), std::string("dt")}));
  EXPECT_TRUE(first.base.settings.empty());
  EXPECT_EQ(
      (std::tuple{first.range.from, first.range.to, first.range.tolerance, first.range.whole}),
      (std::tuple{0.001, 0.25, 0.01, false}));
  EXPECT_EQ(second.base.settings, (SceneSettings{"cloth.grid=[4, 4]", "time.duration=1"}));
  EXPECT_EQ(
      (std::tuple{second.range.from, second.range.to, second.range.tolerance, second.range.whole}),
      (std::tuple{2.0, 64.0, 0.125, true}));
  EXPECT_EQ(frontier_id(second),
            "hang cloth.grid=[4,4] duration=1 mass-spring, frontier of substeps");
}

TEST_F(FrontierFiles, ThatAreWrongAreRefused) {
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"of = \"dt\"\n", ""},
                                 {"from = 0.001\n", ""},
                                 {"to = 0.25\n", ""},
                                 {"solver = \"mass-spring\"\n", ""},
                                 {"to = 0.25", "to = 0.001"},
                                 {"tolerance = 0.125", "tolerance = 0.6"},
                                 {"tolerance = 0.125", "tolerance = 0"},
                                 {"tolerance", "tolerence"},
                                 {"[\"cloth.grid=[4, 4]\"", "[3"},
                                 {"of = \"substeps\"", "of = \"substep\""},
                                 {"[[frontier]]", "more = 1\n[[frontier]]"}})
    EXPECT_THROW(read(changed(kTwo, from, to)), InputError) << to;
}

TEST_F(FrontierFiles, WhatWasFoundIsARowOfItsBaseline) {
  const FrontierQuestion question = read(kTwo)[1];
  CaseFrontier found;
  found.frontier.kind = Frontier::Kind::bracketed;
  found.frontier.stable = 5;
  found.frontier.unstable = 6;
  found.frontier.stable_above = {8, 9};
  BaselineRow row = frontier_row(question, found);
  const Case base = make_case(question.base);
  EXPECT_EQ(row.id, frontier_id(question));
  EXPECT_EQ((std::tuple{row.spec.scene, row.spec.solver, row.spec.settings}),
            (std::tuple{std::string("hang"), std::string("mass-spring"), question.base.settings}));
  EXPECT_EQ(row.scene, digest(*base.scene));
  EXPECT_EQ(row.frontier, "--of substeps --from 2 --to 64 --tolerance 0.125");
  EXPECT_EQ(row.status.kind, "bracketed");
  EXPECT_EQ(row.values,
            (std::map<std::string, double>{
                {"frontier.stable", 5}, {"frontier.unstable", 6}, {"frontier.stable_above", 2}}));
  found.frontier.kind = Frontier::Kind::all_stable;
  found.frontier.stable_above.clear();
  row = frontier_row(question, found);
  EXPECT_EQ(row.status.kind, "all stable");
  EXPECT_EQ(row.values, (std::map<std::string, double>{{"frontier.stable_above", 0}}));
}

TEST(ClaimFigures, AreTheNumberThatSpeaksForTheClaim) {
  const auto finding = [](const char* quantity, double measured, double expected, double tolerance,
                          TruthVerdict verdict, const char* unit = "1") {
    return Finding{
        "jakobsen:iterations=3", quantity, unit, measured, expected, tolerance, 0, verdict, ""};
  };
  /// Verdict and number of the claim that this truth supports, given these findings.
  const auto judged = [](const std::vector<Finding>& findings) {
    const Assertion& claim = *std::ranges::find_if(
        assertions(), [](const auto& c) { return !c.truth.empty() && c.figure.empty(); });
    for (const JudgedAssertion& one : judge_assertions(
             [&](std::string_view truth) { return truth == claim.truth ? &findings : nullptr; }))
      if (one.assertion == claim.assertion)
        return std::pair(
            std::string(one.verdict == claim.verdict ? "as before" : to_string(one.verdict)),
            one.figure);
    return std::pair(std::string("none"), std::string());
  };
  using Both = std::pair<std::string, std::string>;
  const auto a = finding("RMS stretch", 0.061234, 0.06, 0.0123, TruthVerdict::passed),
             b = finding("depth", 0.00312345, 0, 0.005, TruthVerdict::passed, "m"),
             c = finding("speed", 3, 1, 0.5, TruthVerdict::broken, "m/s"),
             d = finding("nothing", 0, 0, 0, TruthVerdict::not_applicable);
  EXPECT_EQ(judged({d, a, b}), Both("as before", "jakobsen: RMS stretch 0.06123 (0.06 +- 0.0123)"));
  EXPECT_EQ(judged({b, a}), Both("as before", "jakobsen: depth 0.003123 m (at most 0.005)"));
  EXPECT_EQ(judged({a, b, c}), Both("overturned", "jakobsen: speed 3 m/s (1 +- 0.5)"));
  EXPECT_EQ(judged({d}), Both("overturned", ""));
}

TEST(ClaimFigures, AreOfTheQuantityThatTheClaimQuotes) {
  const auto finding = [](const std::string& quantity, double measured) {
    return Finding{"bullet", quantity, "1", measured, 1, 0.5, 0, TruthVerdict::passed, ""};
  };
  int quoted = 0;
  for (const Assertion& claim : assertions()) {
    if (claim.figure.empty()) continue;
    const std::string own(claim.figure);
    const std::vector<Finding> findings{finding("not " + own, 0.5), finding(own + " of it", 0.75),
                                        finding(own, 1.25), finding(own, 1.4)};
    for (const JudgedAssertion& one : judge_assertions(
             [&](std::string_view truth) { return truth == claim.truth ? &findings : nullptr; })) {
      if (one.source != claim.source || one.assertion != claim.assertion) continue;
      EXPECT_EQ(one.figure, "bullet: " + own + " 1.25 (1 +- 0.5)") << "the first of that name";
      EXPECT_EQ(one.verdict, claim.verdict);
      ++quoted;
    }
  }
  EXPECT_GT(quoted, 0);
}

}  // namespace
}  // namespace taut::frontier_rows_test
