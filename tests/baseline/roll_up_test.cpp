// Summary of moved values by solver and value.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "experiments/baseline/baseline.hpp"

namespace taut::roll_up_test {
namespace {

Change moved(const char* solver, const char* value, double before, double now) {
  Change c;
  c.id = c.solver = solver;
  c.scene = "hang";
  c.value = value;
  c.before = before;
  c.now = now;
  return c;
}

/// Moved values, grouped by the part of the name before the first dot.
std::vector<MovedValue> rolled(const Comparison& comparison) {
  return roll_up(comparison,
                 [](const std::string& value) { return value.substr(0, value.find('.')); });
}

TEST(RollUp, NamesTheLargestChangeOfASolversValues) {
  Comparison comparison;
  comparison.findings = {
      moved("xpbd", "stretch.rms", 0.01, 0.0101), moved("xpbd", "stretch.max", 0.01, 0.0098),
      moved("bullet", "stretch.rms", -0.5, -0.25), moved("xpbd", "penetration.max", 0.001, 0.002)};
  for (int i = 0; i < 2; ++i)
    comparison.findings.push_back(
        {Change::Kind::status_changed, "hang", "xpbd", "status ok -> crash", "hang", "status"});
  comparison.findings.push_back({Change::Kind::case_new, "new", "", "is new"});
  const auto all = rolled(comparison);
  ASSERT_EQ(all.size(), 4u);
  const auto& [solver, group, cases, less, more, largest] = all[0];
  EXPECT_EQ((std::tuple(solver, group.title(), cases, less, more)),
            (std::tuple(std::string("xpbd"), std::string("stretch"), std::size_t{2}, std::size_t{1},
                        std::size_t{1})));
  EXPECT_EQ(largest, &comparison.findings[1]);
  EXPECT_NEAR(all[0].relative(), -0.02, 1e-12);
  EXPECT_DOUBLE_EQ(all[1].relative(), 0.5) << "a share of the size of what was";
  EXPECT_DOUBLE_EQ(all[2].relative(), 1);
  EXPECT_EQ(all[3].group.kind, MovedGroup::Kind::status);
  EXPECT_EQ(all[3].group.title(), "status");
  EXPECT_EQ(all[3].cases, 2u);
}

// Titles are for people: a value that is called like a group is not counted in it.
TEST(RollUp, GroupsAreNoTitles) {
  using Kind = MovedGroup::Kind;
  const auto group = [](const Change& change, const char* title) {
    return group_of(change, [&](const std::string&) { return std::string(title); });
  };
  const Change of_value = moved("xpbd", "a", 1, 2), of_work = moved("xpbd", kProjections, 1, 2);
  Change of_status = moved("xpbd", "status", 0, 0);
  of_status.kind = Change::Kind::status_changed;
  EXPECT_EQ(group(of_status, "RMS stretch").kind, Kind::status);
  EXPECT_EQ(group(of_work, "").kind, Kind::projections);
  EXPECT_EQ(group(of_value, "").title(), "other values");
  for (const char* title : {"status", "projections", "other values"}) {
    const MovedGroup titled = group(of_value, title);
    EXPECT_EQ(titled.kind, Kind::titled);
    EXPECT_EQ(titled.title(), title);
    EXPECT_FALSE(titled == group(of_value, "")) << title;
    EXPECT_FALSE(titled == group(of_status, title)) << title;
    EXPECT_FALSE(titled == group(of_work, title)) << title;
  }
}

TEST(RollUp, FromNothingIsWorseThanAnyPerCent) {
  Comparison comparison;
  comparison.findings = {moved("xpbd", "a", 1, 5), moved("xpbd", "a", 0, 1e-9),
                         moved("xpbd", "b", 1, std::numeric_limits<double>::quiet_NaN()),
                         moved("xpbd", "b", 1, -900)};
  const auto all = rolled(comparison);
  EXPECT_EQ(all[0].largest, &comparison.findings[1]);
  EXPECT_EQ(all[1].largest, &comparison.findings[2]);
  EXPECT_TRUE(std::isinf(all[1].relative()));
}

TEST(RollUp, OnlyAnotherAnswerIsCounted) {
  Comparison comparison;
  for (const auto kind : {Change::Kind::value_moved, Change::Kind::status_changed,
                          Change::Kind::case_missing, Change::Kind::value_new}) {
    Change one = moved("xpbd", "a", 0, 0);
    one.kind = kind;
    comparison.findings.push_back(one);
  }
  ASSERT_EQ(rolled(comparison).size(), 2u) << "a value that moved, and a status";
  for (const MovedValue& one : rolled(comparison)) EXPECT_EQ(one.cases, 1u);
  std::string said;
  for (const Change& one : comparison.findings)
    said += one.is_regression() ? 'r' : one.is_mismatch() ? 'm' : '-';
  EXPECT_EQ(said, "rrm-");
  EXPECT_EQ(to_string(Change::Kind::value_moved), "value moved");
  EXPECT_EQ(to_string(Change::Kind::value_new), "value new");
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
