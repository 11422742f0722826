// What moved, by scene and value.
#include <gtest/gtest.h>

#include <limits>
#include <tuple>
#include <utility>

#include "experiments/baseline/baseline.hpp"

namespace taut::roll_up_test {
namespace {

Change moved(const char* scene, const char* value, double before, double now) {
  Change c;
  c.id = scene, c.scene = scene, c.value = value, c.before = before, c.now = now;
  return c;
}

TEST(RollUp, TheLargestChangeOfEveryValueIsNamedAndTheLargestIsFirst) {
  Comparison comparison;
  comparison.findings = {moved("hang", "stretch.rms", 0.01, 0.0101),
                         moved("hang", "stretch.rms", 0.01, 0.0098),
                         moved("ball", "penetration.max", 0.001, 0.002)};
  for (int i = 0; i < 2; ++i)
    comparison.findings.push_back(
        {Change::Kind::status_changed, "hang", "", "status ok -> crash", "hang", "status"});
  comparison.findings.push_back({Change::Kind::case_new, "new", "", "is new"});
  const auto all = roll_up(comparison);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].value, "status") << "a failure is no smaller than any change of a value";
  EXPECT_EQ(all[0].cases, 2u);
  EXPECT_EQ(text(all[0], ""), "status ok -> crash");
  EXPECT_EQ(all[1].value, "penetration.max");
  EXPECT_EQ(text(all[1], "m"), "+100 % (0.001 -> 0.002 m)");
  EXPECT_EQ(all[2].cases, 2u);
  EXPECT_EQ(std::pair(all[2].less, all[2].more), std::pair(std::size_t{1}, std::size_t{1}));
  EXPECT_EQ(text(all[2], "1"), "-2 % (0.01 -> 0.0098)");
}

TEST(RollUp, FromNothingIsWorseThanAnyPerCent) {
  Comparison comparison;
  comparison.findings = {moved("hang", "a", 1, 5), moved("hang", "b", 0, 1e-9),
                         moved("hang", "c", 1, std::numeric_limits<double>::quiet_NaN())};
  const auto all = roll_up(comparison);
  EXPECT_EQ(all[0].value, "b");
  EXPECT_EQ(all[1].value, "c");
  EXPECT_EQ(text(all[1], "1"), "1 -> nan");
  EXPECT_EQ(all[2].value, "a");
}

TEST(RollUp, ChangesAreSharesOfTheSizeOfWhatWasWhateverTheirSign) {
  Comparison comparison;
  comparison.findings = {moved("hang", "a", -0.5, -0.25), moved("hang", "b", 2, -4),
                         moved("hang", "c", 2, 4),        moved("ball", "c", 2, 1.5),
                         moved("hang", "c", 2, -3),       moved("hang", "c", 2, 2)};
  const auto all = roll_up(comparison);
  ASSERT_EQ(all.size(), 4u);
  std::string order;
  for (const MovedValue& one : all) order += one.scene + " " + one.value + ", ";
  EXPECT_EQ(order, "hang b, hang c, hang a, ball c, ");
  EXPECT_EQ(text(all[0], "J"), "-300 % (2 -> -4 J)");
  EXPECT_EQ(text(all[1], ""), "-250 % (2 -> -3)");
  EXPECT_EQ(text(all[2], "1"), "+50 % (-0.5 -> -0.25)");
  EXPECT_EQ(text(all[3], "m"), "-25 % (2 -> 1.5 m)");
  EXPECT_EQ((std::tuple{all[1].cases, all[1].less, all[1].more}),
            (std::tuple{std::size_t{3}, std::size_t{1}, std::size_t{1}}));
}

TEST(RollUp, OnlyAnotherAnswerIsCounted) {
  Comparison comparison;
  for (const auto kind : {Change::Kind::value_moved, Change::Kind::status_changed,
                          Change::Kind::case_missing, Change::Kind::value_new}) {
    Change one = moved("hang", "a", 0, 0);
    one.kind = kind;
    comparison.findings.push_back(one);
  }
  ASSERT_EQ(roll_up(comparison).size(), 1u);
  EXPECT_EQ(roll_up(comparison)[0].cases, 2u);
  std::string said;
  for (const Change& one : comparison.findings)
    said += one.is_regression() ? 'r' : one.is_mismatch() ? 'm' : '-';
  EXPECT_EQ(said, "rrm-");
}

TEST(JUnit, TextsAreNoMarkupAndOnlyFailuresFail) {
  Baseline now(1);
  now[0].id = "a & \"b\" <c>";
  Comparison comparison;
  const auto add = [&](Change::Kind kind, const char* id, const char* solver, const char* text) {
    comparison.findings.push_back({kind, id, solver, text});
  };
  add(Change::Kind::value_new, "a & \"b\" <c>", "s", "for information");
  add(Change::Kind::solver_missing, "", "s", "gone");
  add(Change::Kind::case_missing, "d", "s", "one");
  add(Change::Kind::value_moved, "d", "s", "two > one");
  EXPECT_EQ(junit("x", now, comparison),
            "<testsuite name=\"x\" tests=\"3\" failures=\"2\">\n"
            "  <testcase classname=\"x\" name=\"a &amp; &quot;b&quot; &lt;c&gt;\"/>\n"
            "  <testcase classname=\"x\" name=\"d\"><failure>one\ntwo &gt; one\n</failure>"
            "</testcase>\n"
            "  <testcase classname=\"x\" name=\"solver s\"><failure>gone\n</failure></testcase>\n"
            "</testsuite>\n");
}

}  // namespace
}  // namespace taut::roll_up_test
