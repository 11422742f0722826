// Comparisons with a baseline: fields and words of every finding, tolerances at their limits, and
// the rows that an update writes.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/model/input_error.hpp"
#include "experiments/baseline/baseline.hpp"
#include "experiments/system/files.hpp"

namespace taut::comparison_test {
namespace {

using Kind = Change::Kind;
const double kNaN = std::nan(""), kInfinity = std::numeric_limits<double>::infinity();

BaselineRow row(const std::string& scene, const std::string& solver,
                std::map<std::string, double> values) {
  return {scene + " " + solver, {scene, {}, solver}, "content of " + scene, {"ok"}, 100,
          std::move(values)};
}

TEST(Findings, HaveTheirCaseTheirValueAndWhatItWas) {
  const Baseline before{row("ball", "bullet", {{"stretch.max", 0.25}, {"old", 1}}),
                        row("hang", "jakobsen", {{"stretch.max", 0.5}})};
  Baseline now = before;
  now[0].status = {"exploded", "energy"};
  now[0].projections = 90;
  now[0].values = {{"stretch.max", kNaN}, {"new", 2}, {"none", kNaN}};
  now[1].status = {"timeout"};
  now[1].values["stretch.max"] = 0.5000001;
  const Comparison found =
      compare(before, now, Tolerances({{"default", {0, 1e-9, false, "close"}}}));
  struct Expected {
    Kind kind;
    const char *id, *solver, *scene, *value, *text;
    double before = 0, now = 0;
  };
  const Expected all[] = {
      {Kind::status_changed, "ball bullet", "bullet", "ball", "status",
       "status ok -> exploded (energy)"},
      {Kind::value_moved, "ball bullet", "bullet", "ball", "projections",
       "projections per step 100 -> 90", 100, 90},
      {Kind::value_missing, "ball bullet", "bullet", "", "", "old 1 -> no such value"},
      {Kind::value_moved, "ball bullet", "bullet", "ball", "stretch.max",
       "stretch.max 0.25 -> none", 0.25, kNaN},
      {Kind::value_new, "ball bullet", "bullet", "", "", "new has no baseline; now 2"},
      {Kind::status_changed, "hang jakobsen", "jakobsen", "hang", "status", "status ok -> timeout"},
      {Kind::value_moved, "hang jakobsen", "jakobsen", "hang", "stretch.max",
       "stretch.max 0.5 -> 0.5000001 (by 1e-7, allowed 5e-10)", 0.5, 0.5000001}};
  ASSERT_EQ(found.findings.size(), std::size(all));
  for (std::size_t i = 0; i < std::size(all); ++i) {
    const Change& is = found.findings[i];
    EXPECT_EQ(is.kind, all[i].kind) << i;
    EXPECT_EQ(is.text, all[i].text);
    EXPECT_EQ((std::tuple{is.id, is.solver, is.scene, is.value}),
              (std::tuple{std::string(all[i].id), std::string(all[i].solver),
                          std::string(all[i].scene), std::string(all[i].value)}));
    EXPECT_EQ(is.before, all[i].before);
    EXPECT_TRUE(is.now == all[i].now || (std::isnan(is.now) && std::isnan(all[i].now))) << i;
  }
  EXPECT_EQ(found.cases, 2u);
  EXPECT_EQ(found.values, 2u);
}

TEST(Findings, OfAValueThatItsOwnRowLacksAndOthersHave) {
  const Baseline before{row("a", "s", {{"x", 1}}), row("b", "s", {})};
  Baseline now = before;
  now[1].values = {{"x", 2}, {"y", 3}};
  const Comparison found = compare(before, now, {});
  ASSERT_EQ(found.findings.size(), 2u);
  EXPECT_EQ(found.findings[0].kind, Kind::value_unrecorded);
  EXPECT_EQ(found.findings[0].text, "x has no baseline in this row alone; now 2");
  EXPECT_EQ(found.findings[1].kind, Kind::value_new);
  EXPECT_TRUE(found.mismatched());
  EXPECT_FALSE(found.regressed());
}

TEST(Findings, DifferencesBeyondTheSeventhDigitAreShown) {
  const Baseline before{row("a", "s", {{"x", 1.25}})};
  Baseline now = before;
  now[0].values["x"] = 1.25 + 1e-10;
  const Comparison found = compare(before, now, Tolerances({{"default", {0, 0, false, "same"}}}));
  EXPECT_EQ(found.findings.at(0).text, "x 1.25 -> 1.2500000001 (by 1e-10, allowed 0)");
}

TEST(Findings, OfAFlakyRowAreItsStatusAlone) {
  Baseline before{row("a", "s", {{"x", 1}})}, now = before;
  now[0].values["x"] = 2;
  now[0].projections = 1;
  now[0].flaky = true;
  Comparison found = compare(before, now, {});
  ASSERT_EQ(found.findings.size(), 1u);
  EXPECT_EQ(found.findings[0].text, "does not repeat bit for bit: now flaky");
  EXPECT_FALSE(found.regressed() || found.mismatched());
  before[0].flaky = true;
  EXPECT_TRUE(compare(before, now, {}).findings.empty());
  now[0].flaky = false;
  now[0].status = {"crash"};
  found = compare(before, now, {});
  ASSERT_EQ(found.findings.size(), 1u);
  EXPECT_EQ(found.findings[0].kind, Kind::status_changed);
  EXPECT_EQ(found.values, 0u);
}

TEST(Findings, OfCasesThatDoNotMatchNameBoth) {
  const Baseline before{row("a", "s", {}), row("b", "s", {}), row("c", "s", {})};
  Baseline now{row("a", "s", {}), row("b", "s", {}), row("d", "s", {})};
  now[0].id = "another";
  now[1].scene = "0123456789abcdef";
  const Comparison found = compare(before, now, {});
  std::vector<std::string> texts;
  for (const Change& one : found.findings) texts.push_back(one.id + ": " + one.text);
  EXPECT_EQ(texts, (std::vector<std::string>{
                       "another: renamed: the baseline calls it 'a s'",
                       "b s: the scene changed: content content of b -> 0123456789ab",
                       "c s: missing: the study does not have this case of the baseline",
                       "d s: new: the baseline does not have this case"}));
}

TEST(Tolerated, IsWhatIsWithinBothAndNotOneBitMore) {
  const Tolerance half{0.5, 0.25, false, ""};
  EXPECT_TRUE(half.holds(3, 2)) << "0.5 and a quarter of two";
  EXPECT_TRUE(half.holds(1, 2));
  EXPECT_TRUE(half.holds(-1, -2));
  EXPECT_FALSE(half.holds(std::nextafter(3, 4), 2));
  EXPECT_FALSE(half.holds(1 - 1e-15, 2));
  const Tolerance none{0, 0, false, ""};
  EXPECT_TRUE(none.holds(kNaN, kNaN));
  EXPECT_FALSE(none.holds(kNaN, 1));
  EXPECT_FALSE(none.holds(1, kNaN));
  EXPECT_TRUE(none.holds(kInfinity, kInfinity));
  EXPECT_FALSE(half.holds(kInfinity, 1));
  const Tolerance& usual = Tolerances().of("anything");
  EXPECT_EQ((std::tuple{usual.absolute, usual.relative, usual.ignored}),
            (std::tuple{1e-12, 1e-6, false}));
  const Tolerances special({{"a.b", {1, 0, false, ""}}});
  EXPECT_EQ(special.of("a.b.c").absolute, 1) << "of the value's metric";
  EXPECT_EQ(special.of("a.bc").absolute, 1e-12);
  EXPECT_EQ(special.of("a").absolute, 1e-12);
}

TEST(Tolerated, ValuesThatAreIgnoredAreNeitherComparedNorKept) {
  const Tolerances ignoring({{"x", {0, 0, true, "chance"}}});
  const Baseline before{row("a", "s", {{"x", 1}, {"y", 1}})};
  Baseline now{row("a", "s", {{"x", 2}, {"y", 1}, {"x.more", 3}})};
  const Comparison found = compare(before, now, ignoring);
  EXPECT_TRUE(found.findings.empty());
  EXPECT_EQ(found.values, 1u);
  EXPECT_EQ(updated(before, now, ignoring)[0].values, (std::map<std::string, double>{{"y", 1}}));
}

TEST(Updates, KeepTheFewestDigitsTheToleranceAsksFor) {
  const auto kept = [](double value, const Tolerance& t) {
    return updated({}, {row("a", "s", {{"x", value}})}, Tolerances({{"x", t}}))[0].values.at("x");
  };
  EXPECT_EQ(kept(1.23456789, {0.1, 0, false, ""}), 1.235);
  EXPECT_EQ(kept(1.2345, {0.1, 0, false, ""}), 1.234)
      << "half of a thousandth is within a thousandth";
  EXPECT_EQ(kept(-123.456, {0, 0.1, false, ""}), -123.5);
  EXPECT_EQ(kept(123.456, {10, 0.1, false, ""}), 123.5);
  EXPECT_EQ(kept(0.1 + 0.2, {0, 0, false, ""}), 0.1 + 0.2) << "all of them";
  EXPECT_EQ(kept(kInfinity, {0.1, 0, false, ""}), kInfinity);
  EXPECT_TRUE(std::isnan(kept(kNaN, {0.1, 0, false, ""})));
}

TEST(Updates, TakeRowsOfAnotherQuestionAnew) {
  const Tolerances loose({{"default", {0, 0.5, false, ""}}});
  const Baseline before{row("b", "s", {{"x", 1}}), row("a", "s", {{"x", 1}})};
  Baseline now{row("b", "s", {{"x", 1.25}}), row("a", "s", {{"x", 1.25}})};
  const auto values = [&] {
    std::vector<double> all;
    for (const BaselineRow& one : updated(before, now, loose)) all.push_back(one.values.at("x"));
    return all;
  };
  EXPECT_EQ(values(), (std::vector<double>{1, 1}));
  now[1].scene = "other";
  EXPECT_EQ(values(), (std::vector<double>{1.25, 1})) << "sorted by id";
  now[0].frontier = "--of dt";
  EXPECT_EQ(values(), (std::vector<double>{1.25, 1.25}));
  now[0].frontier = "";
  now[0].spec.solver = "s:k=1";
  EXPECT_EQ(values(), (std::vector<double>{1.25, 1.25}));
}

TEST(Reproduced, AreFrontiersByTheirOwnVerb) {
  BaselineRow one = row("my scene.toml", "jakobsen:iterations=3", {});
  one.spec.settings = {"a=1"};
  EXPECT_EQ(reproduce(one), "taut case 'my scene.toml' jakobsen:iterations=3 --set a=1");
  one.frontier = "--of dt --from 1";
  EXPECT_EQ(reproduce(one),
            "taut frontier 'my scene.toml' jakobsen:iterations=3 --set a=1 --of dt --from 1");
}

TEST(Reproduced, AStatusHasItsReasonUnlessItRefuses) {
  Record record;
  record.spec.solver = "jakobsen";
  record.status = {Status::Kind::exploded, Reason::box, 3, 4};
  EXPECT_EQ(baseline_row(record, "c").status, (RowStatus{"exploded", "box"}));
  record.status = {Status::Kind::unsupported, "no contact", -1, -1};
  EXPECT_EQ(baseline_row(record, "c").status, RowStatus{"unsupported"});
  record.status = {};
  record.projections = 7;
  record.id = "id";
  record.values = {{"x", 1}};
  const BaselineRow made = baseline_row(record, "c");
  EXPECT_EQ((std::tuple{made.status, made.projections, made.id, made.scene}),
            (std::tuple{RowStatus{"ok"}, std::size_t{7}, std::string("id"), std::string("c")}));
  EXPECT_EQ(made.values, record.values);
  EXPECT_EQ(made.solver(), "jakobsen");
}

TEST(BaselineFolders, KeepEveryFieldAndRefuseWhatTheyShould) {
  const Scratch scratch;
  BaselineRow one = row("a", "s:k=2", {{"x", 0.1 + 0.2}, {"none", kNaN}});
  one.spec.settings = {"b=\"1\"", "c=2"};
  one.flaky = true;
  one.frontier = "--of dt";
  one.status = {"exploded", "energy"};
  write_baseline(scratch.path(), {row("z", "s", {}), one, row("a", "t", {})});
  const Baseline back = read_baseline(scratch.path());
  ASSERT_EQ(back.size(), 3u);
  EXPECT_EQ(
      (std::tuple{back[0].id, back[0].spec.scene, back[0].spec.settings, back[0].spec.solver}),
      (std::tuple{one.id, one.spec.scene, one.spec.settings, one.spec.solver}));
  EXPECT_EQ((std::tuple{back[0].scene, back[0].status, back[0].projections, back[0].frontier,
                        back[0].flaky}),
            (std::tuple{one.scene, one.status, one.projections, one.frontier, true}));
  EXPECT_EQ(back[0].values.at("x"), 0.1 + 0.2);
  EXPECT_TRUE(std::isnan(back[0].values.at("none")));
  EXPECT_EQ(back[1].id, "a t");
  EXPECT_EQ(back[2].id, "z s");
  EXPECT_FALSE(back[2].flaky);
  EXPECT_EQ(back[2].frontier, "");
  write_file(scratch.path() / "tolerances.toml",
             "[default]\nrelative = 1\nreason = \"a\"\n[x]\nabsolute = 0.25\nreason = "
             "\"b\"\n[\"y.z\"]\nignored = true\nreason = \"c\"\n");
  const Tolerances read = read_tolerances(scratch.path());
  EXPECT_EQ((std::tuple{read.of("other").relative, read.of("x").absolute, read.of("x").relative,
                        read.of("y.z").ignored, read.of("x").ignored}),
            (std::tuple{1.0, 0.25, 0.0, true, false}));
  EXPECT_EQ(read.of("x.max").reason, "b");
  for (const char* wrong :
       {"[x]\nrelative = 1.1\nreason = \"a\"\n", "[x]\nabsolute = -1\nreason = \"a\"\n",
        "[x]\nreason = \"\"\n", "[x]\nreason = \"a\"\nrelativ = 1\n", "x = 3\n"}) {
    write_file(scratch.path() / "tolerances.toml", wrong);
    EXPECT_THROW(read_tolerances(scratch.path()), InputError) << wrong;
  }
}

}  // namespace
}  // namespace taut::comparison_test
