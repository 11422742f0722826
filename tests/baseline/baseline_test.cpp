// Regressions: every way in which a run can differ from its baseline has a name and fails.
#include "experiments/baseline/baseline.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iterator>

#include "core/model/input_error.hpp"

namespace taut::baseline_test {
namespace {

namespace fs = std::filesystem;
using Kind = Change::Kind;

BaselineRow row(const std::string& scene, const std::string& solver, double stretch) {
  return {scene + " " + solver,
          {scene, {}, solver},
          "content of " + scene,
          {"ok"},
          100,
          {{"stretch.max", stretch}, {"drift.max", std::nan("")}}};
}

Baseline two() {
  return {row("ball", "jakobsen:iterations=3", 0.5), row("hang", "bullet:iterations=3", 0.25)};
}

std::vector<Kind> kinds(const Comparison& comparison) {
  std::vector<Kind> all;
  for (const Change& finding : comparison.findings) all.push_back(finding.kind);
  return all;
}

/// Comparison with a changed copy of the baseline.
template <class Change>
Comparison after(const Change& change) {
  Baseline now = two();
  change(now);
  return compare(two(), now, {});
}

TEST(Baseline, ARowKeepsParametersThatAreNoDefaults) {
  Record record;
  record.spec.solver = parse_solver("jakobsen:iterations=7").canonical();
  record.status = {Status::Kind::exploded, Reason::energy, 12, 3};
  const BaselineRow r = baseline_row(record, "content");
  EXPECT_EQ(r.spec.solver, "jakobsen:iterations=7");
  EXPECT_EQ(r.status, (RowStatus{"exploded", "energy"}));
}

TEST(Baseline, TheSameRunHasNothingToReport) {
  const Comparison c = compare(two(), two(), {});
  EXPECT_TRUE(c.findings.empty());
  EXPECT_EQ(c.cases, 2u);
  EXPECT_EQ(c.values, 4u);
}

TEST(Baseline, AMovedValueSaysFromWhatToWhat) {
  const Comparison c = after([](Baseline& now) { now[0].values["stretch.max"] = 0.6; });
  ASSERT_EQ(kinds(c), std::vector{Kind::value_moved});
  EXPECT_EQ(c.findings[0].text, "stretch.max 0.5 -> 0.6 (by 0.1, allowed 5e-7)");
  EXPECT_EQ(c.findings[0].id, "ball jakobsen:iterations=3");
  EXPECT_TRUE(c.regressed());
}

TEST(Baseline, AValueThatAppearsOrVanishesIsARegression) {
  EXPECT_EQ(kinds(after([](Baseline& now) { now[0].values["drift.max"] = 0; })),
            std::vector{Kind::value_moved});
  EXPECT_EQ(kinds(after([](Baseline& now) { now[0].values["stretch.max"] = std::nan(""); })),
            std::vector{Kind::value_moved});
}

TEST(Baseline, StatusAndWorkAreCompared) {
  EXPECT_EQ(kinds(after([](Baseline& now) {
              now[1].status = {"exploded", "energy"};
            })),
            std::vector{Kind::status_changed});
  EXPECT_EQ(kinds(after([](Baseline& now) { now[1].projections = 101; })),
            std::vector{Kind::value_moved});
}

TEST(Baseline, EveryMismatchHasItsOwnName) {
  const auto missing =
      after([](Baseline& now) { now.push_back(row("box", "bullet:iterations=3", 1)); });
  EXPECT_EQ(kinds(missing), std::vector{Kind::case_new});
  EXPECT_FALSE(missing.regressed());
  EXPECT_TRUE(missing.mismatched());
  Baseline before = two();
  before.push_back(row("box", "bullet:iterations=3", 1));
  EXPECT_EQ(kinds(compare(before, two(), {})), std::vector{Kind::case_missing});
  EXPECT_EQ(kinds(after([](Baseline& now) { now[0].id = "other"; })),
            std::vector{Kind::case_renamed});
  EXPECT_EQ(kinds(after([](Baseline& now) { now[0].scene = "other"; })),
            std::vector{Kind::scene_changed});
  EXPECT_EQ(kinds(after([](Baseline& now) { now.pop_back(); })), std::vector{Kind::solver_missing});
  EXPECT_EQ(kinds(after([](Baseline& now) { now.push_back(row("hang", "other", 1)); })),
            std::vector{Kind::solver_new});
  EXPECT_EQ(kinds(after([](Baseline& now) { now[0].values.erase("stretch.max"); })),
            std::vector{Kind::value_missing});
}

TEST(Baseline, ANewMetricIsNoFailure) {
  const Comparison c = after([](Baseline& now) { now[0].values["new.value"] = 1; });
  EXPECT_EQ(kinds(c), std::vector{Kind::value_new});
  EXPECT_FALSE(c.regressed() || c.mismatched());
}

TEST(Baseline, NothingInCommonComparesNothing) {
  const Comparison c = compare({}, two(), {});
  EXPECT_EQ(c.cases, 0u);
  EXPECT_TRUE(c.mismatched());
}

TEST(Baseline, TheMostSpecialToleranceHolds) {
  const Tolerances t({{"default", {0, 0.1, false, "a"}},
                      {"stretch", {0, 0.01, false, "b"}},
                      {"stretch.max", {1, 0, false, "c"}},
                      {"jitter", {0, 0, true, "d"}}});
  EXPECT_EQ(t.of("energy.mean").reason, "a");
  EXPECT_EQ(t.of("stretch.rms").reason, "b");
  EXPECT_EQ(t.of("stretch.max").reason, "c");
  EXPECT_TRUE(t.of("jitter.max").ignored);
  EXPECT_TRUE(t.of("stretch.max").holds(1.5, 0.5));
  EXPECT_FALSE(t.of("stretch.max").holds(1.6, 0.5));
}

TEST(Baseline, AnUpdateRewritesOnlyValuesThatMoved) {
  const Tolerances t({{"default", {0, 0.01, false, "a hundredth"}}});
  Baseline now = two();
  now[0].values["stretch.max"] = 0.503;       // within the tolerance
  now[1].values["stretch.max"] = 0.31415926;  // beyond the tolerance
  now[0].values["new.value"] = 1.0 / 3;
  const Baseline result = updated(two(), now, t);
  EXPECT_EQ(result[0].values.at("stretch.max"), 0.5);
  EXPECT_EQ(result[0].values.at("new.value"), 0.3333);
  EXPECT_EQ(result[1].values.at("stretch.max"), 0.31416);  // rounded to a relative 1e-4
  EXPECT_TRUE(compare(result, now, t).findings.empty());
}

TEST(Baseline, AnUpdateKeepsTheDigitsTheToleranceNeeds) {
  Baseline now = two();
  for (const auto& [value, absolute, kept] :
       {std::array{107.0, 1000.0, 100.0}, {107.0, 500.0, 110.0}, {107.0, 10.0, 107.0}}) {
    now[0].values["stretch.max"] = value;
    const Tolerances t({{"default", {absolute, 0, false, "some"}}});
    EXPECT_EQ(updated({}, now, t)[0].values.at("stretch.max"), kept) << absolute;
  }
}

TEST(Baseline, ACaseIsReproducedByOneLine) {
  EXPECT_EQ(reproduce({"hang", {"time.dt=\"1/60\"", "cloth.mass=1"}, "jakobsen:iterations=8"}),
            "taut case hang jakobsen:iterations=8 --set 'time.dt=\"1/60\"' --set cloth.mass=1");
}

TEST(Baseline, JUnitHasATestCaseForEveryRowAndEveryLoss) {
  Baseline before = two(), now = two();
  before.push_back(row("box", "bullet:iterations=3", 1));
  now[0].values["stretch.max"] = 1;
  EXPECT_EQ(junit("small <study>", now, compare(before, now, {})),
            "<testsuite name=\"small &lt;study&gt;\" tests=\"3\" failures=\"2\">\n"
            "  <testcase classname=\"small &lt;study&gt;\" name=\"ball jakobsen:iterations=3\">"
            "<failure>stretch.max 0.5 -&gt; 1 (by 0.5, allowed 5e-7)\n</failure></testcase>\n"
            "  <testcase classname=\"small &lt;study&gt;\" name=\"box bullet:iterations=3\">"
            "<failure>missing: the study does not have this case of the baseline\n</failure>"
            "</testcase>\n"
            "  <testcase classname=\"small &lt;study&gt;\" name=\"hang bullet:iterations=3\"/>\n"
            "</testsuite>\n");
}

class BaselineFiles : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string slurp(const std::string& name) const {
    std::ifstream in(folder_ / name);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  const fs::path folder_ =
      fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(BaselineFiles, WhatIsWrittenIsReadBack) {
  write_baseline(folder_, two());
  EXPECT_TRUE(compare(two(), read_baseline(folder_), {}).findings.empty());
  EXPECT_EQ(slurp("bullet.jsonl"),
            "{\"id\":\"hang bullet:iterations=3\",\"scene\":\"hang\",\"settings\":[],"
            "\"solver\":\"bullet:iterations=3\",\"content\":\"content of hang\",\"status\":\"ok\","
            "\"projections\":100,\"values\":{\"drift.max\":null,\"stretch.max\":0.25}}\n");
}

TEST_F(BaselineFiles, OfAnEarlierTautCallTheSettingsOverrides) {
  Baseline rows = two();
  rows[0].spec.settings = {"time.dt=\"1/64\""};
  write_baseline(folder_, rows);
  const std::string name = rows[0].solver() + ".jsonl", text = slurp(name);
  std::string earlier = text;
  earlier.replace(earlier.find("\"settings\""), 10, "\"overrides\"");
  write(name, earlier);
  EXPECT_EQ(read_baseline(folder_)[0].spec.settings, rows[0].spec.settings);
  write_baseline(folder_, read_baseline(folder_));
  EXPECT_EQ(slurp(name), text);
  earlier.replace(earlier.find("\"overrides\""), 11, "\"set\"");
  write(name, earlier);
  try {
    read_baseline(folder_);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("has no 'settings'"), std::string::npos)
        << error.what();
  }
}

TEST_F(BaselineFiles, ANoOpUpdateTouchesNoFile) {
  write_baseline(folder_, two());
  const auto stamp = fs::last_write_time(folder_ / "bullet.jsonl") - std::chrono::hours(1);
  fs::last_write_time(folder_ / "bullet.jsonl", stamp);
  write_baseline(folder_, updated(read_baseline(folder_), two(), {}));
  EXPECT_EQ(fs::last_write_time(folder_ / "bullet.jsonl"), stamp);
  write_baseline(folder_, {two()[0]});
  EXPECT_FALSE(fs::exists(folder_ / "bullet.jsonl"));
}

TEST_F(BaselineFiles, CorruptRowsAreNamedByLine) {
  write_baseline(folder_, two());
  write("bullet.jsonl", slurp("bullet.jsonl") + "{\"id\": \"x\"\n" + slurp("jakobsen.jsonl"));
  try {
    read_baseline(folder_);
    FAIL();
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("bullet.jsonl:2:1: not a baseline row"), what.npos) << what;
    EXPECT_NE(what.find("bullet.jsonl:3:1: this row belongs to jakobsen"), what.npos) << what;
    EXPECT_NE(what.find("two rows are called"), what.npos) << what;
  }
}

TEST_F(BaselineFiles, TolerancesNeedAReason) {
  EXPECT_TRUE(read_baseline(folder_).empty());
  EXPECT_EQ(read_tolerances(folder_).of("x").relative, 1e-6);
  write("tolerances.toml", "[default]\nrelative = 1e-3\nreason = \"why not\"\n");
  EXPECT_EQ(read_tolerances(folder_).of("x").relative, 1e-3);
  write("tolerances.toml", "[default]\nrelative = 2\n");
  EXPECT_THROW(read_tolerances(folder_), InputError);
}

}  // namespace
}  // namespace taut::baseline_test
