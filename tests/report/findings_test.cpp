// What other verbs left in a results folder, as a report has it.
#include "experiments/report/findings.hpp"

#include <gtest/gtest.h>

#include "core/model/input_error.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"

namespace taut::report::findings_test {
namespace {

Json finding(const std::string& subject, double expected, double tolerance, double measured,
             const std::string& verdict = "passed", const std::string& unit = "m") {
  return {{"subject", subject},
          {"unit", unit},
          {"expected", expected},
          {"tolerance", tolerance},
          {"measured", measured},
          {"verdict", verdict},
          {"why", verdict == "passed" ? "" : "reasons"}};
}

Truths truths_of(const std::vector<std::vector<Json>>& findings) {
  const Scratch scratch;
  Json all{{"schema", "taut-truths-2"},
           {"program", "p"},
           {"truths", Json::array()},
           {"assertions", {{{"assertion", "c"}, {"verdict", "holds"}, {"figure", "f"}}}}};
  for (const auto& of_truth : findings)
    all["truths"].push_back(
        {{"section_title", "S"}, {"statement", "T"}, {"source", "Q"}, {"findings", of_truth}});
  write_file(scratch.path() / "verify.json", all.dump());
  EXPECT_FALSE(stored_truths(scratch.path(), "another"));
  return *stored_truths(scratch.path(), "p");
}

TEST(StoredTruths, ShowOfEachTruthTheFindingNearestToItsTolerance) {
  const Truths truths =
      truths_of({{finding("far", 1, 0.1, 1.02), finding("near", 1, 0.1, 0.92),
                  finding("apart", 1, 0.1, 1.5, "deviates"), finding("wide", 1, 1, 1.5),
                  finding("none", 1, 0.1, 1, "not applicable")},
                 {finding("exact", 2, 0, 2), finding("off", 2, 0, 2.5)},
                 {}});
  EXPECT_EQ(truths.truths, 3);
  EXPECT_EQ(truths.findings, 7);
  EXPECT_EQ(truths.verdicts,
            (std::map<std::string, int>{{"deviates", 1}, {"not applicable", 1}, {"passed", 5}}));
  std::vector<std::string> subjects;
  for (const TruthRow& row : truths.rows) subjects.push_back(row.subject);
  EXPECT_EQ(subjects, (std::vector<std::string>{"near", "apart", "none", "off"}));
  EXPECT_EQ(truths.rows[1].why, "reasons");
  EXPECT_EQ(truths.rows[1].verdict, "deviates");
  EXPECT_EQ(truths.rows[2].expected + truths.rows[2].measured, "");
  EXPECT_EQ(truths.rows[0].section + truths.rows[0].statement + truths.rows[0].source, "STQ");
  EXPECT_EQ(truths.assertions.at("c"), (std::pair<std::string, std::string>{"holds", "f"}));
}

TEST(StoredTruths, WriteAsManyDigitsAsTheToleranceLetsMatter) {
  struct Written {
    double expected, tolerance, measured;
    std::string unit, says, found;
  };
  for (const Written& one :
       {Written{0, 1e-3, 2.5e-4, "m", "at most 0.0010 m", "0.00025 m"},
        Written{1, 0.05, 1.0123, "m", "1.00 ± 0.05 m", "1.01 m"},
        Written{1, 0.012, 1.0123, "1", "1.000 ± 0.012", "1.012"},
        Written{1, 1e-6, 1.0000004, "m", "1.000000 ± 0.000001 m", "1.000000 m"},
        Written{1, 1e-7, 1.00000001, "m", "1.00000 ± 10⁻⁷ m", "1.00000 m"},
        Written{2e6, 1, 2000001, "1", "2×10⁶ ± 1.0", "2×10⁶"},
        Written{2.5, 0, 2.5, "m", "exactly 2.50 m", "2.50 m"}}) {
    const Truths truths =
        truths_of({{finding("x", one.expected, one.tolerance, one.measured, "passed", one.unit)}});
    ASSERT_EQ(truths.rows.size(), 1u);
    EXPECT_EQ(truths.rows[0].expected, one.says) << one.tolerance;
    EXPECT_EQ(truths.rows[0].measured, one.found) << one.tolerance;
  }
}

TEST(StoredFindings, AreThoseOfThisProgramAndNoneWithoutAFile) {
  const Scratch scratch;
  const auto put = [&](const std::string& file, const Json& json) {
    make_folder((scratch.path() / file).parent_path());
    write_file(scratch.path() / file, json.dump());
  };
  EXPECT_FALSE(stored_truths(scratch.path(), "p"));
  EXPECT_FALSE(stored_regressions(scratch.path(), "p"));
  EXPECT_TRUE(stored_requirements(scratch.path(), "p").empty());
  EXPECT_TRUE(stored_frontiers(scratch.path(), "p").empty());
  put("check.json", {{"schema", "taut-check-1"},
                     {"program", "p"},
                     {"cases", 7},
                     {"values", 90},
                     {"findings", {{{"study", "s"}, {"case", "c"}, {"change", "a -> b"}}}}});
  const auto found = stored_regressions(scratch.path(), "p");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->cases, 7);
  EXPECT_EQ(found->values, 90);
  ASSERT_EQ(found->rows.size(), 1u);
  EXPECT_EQ(found->rows[0].study + found->rows[0].id + found->rows[0].change, "sca -> b");
  EXPECT_FALSE(stored_regressions(scratch.path(), "q"));
  for (const char* scene : {"b", "a"})
    put(std::string("require/") + scene + "/found.json", {{"schema", "taut-require-1"},
                                                          {"program", "p"},
                                                          {"summary",
                                                           {{"scene", scene},
                                                            {"solver", "jakobsen"},
                                                            {"chaotic", ""},
                                                            {"answers", "all"},
                                                            {"drop", "wind"},
                                                            {"keep", "pins"},
                                                            {"time", "34 %"},
                                                            {"command", "taut run"}}}});
  put("require/c/found.json", {{"schema", "taut-require-1"}, {"program", "q"}});
  const auto required = stored_requirements(scratch.path(), "p");
  ASSERT_EQ(required.size(), 2u);
  EXPECT_EQ(required[0].scene + required[1].scene, "ab");
  EXPECT_EQ(required[0].solver + required[0].answers + required[0].drop + required[0].keep +
                required[0].time + required[0].command,
            "jakobsenallwindpins34 %taut run");
  put("check.json", {{"schema", "taut-check-2"}, {"program", "p"}});
  EXPECT_THROW(stored_regressions(scratch.path(), "p"), InputError);
}

TEST(TheorySlope, IsThatOfPinnedClothInNothingButGravity) {
  Scene scene;
  scene.pins = {{}};
  scene.links = {{}};
  scene.links[0].family = Family::structural;
  EXPECT_EQ(theory_slope(scene), -1);
  const auto spoiled = [&](const auto& spoil) {
    Scene other = scene;
    spoil(other);
    return !theory_slope(other);
  };
  EXPECT_TRUE(spoiled([](Scene& s) { s.pins.clear(); }));
  EXPECT_TRUE(spoiled([](Scene& s) { s.pin_motions.emplace_back(); }));
  EXPECT_TRUE(spoiled([](Scene& s) { s.colliders.emplace_back(); }));
  EXPECT_TRUE(spoiled([](Scene& s) { s.wind.emplace(); }));
  EXPECT_TRUE(spoiled([](Scene& s) { s.self_collision.emplace(); }));
  EXPECT_TRUE(spoiled([](Scene& s) { s.links[0].family = Family::bend; }));
}

TEST(ShownSeries, AreTheColumnsOfTheTableThatAFilmShows) {
  Series table;
  table.columns = {"kinetic", "t", "stretch.rms"};
  table.rows = {{9, 0, 0.1}, {8, 0.5, 0.2}};
  const auto shown = shown_series(table, {"hang", "jakobsen", "Jakobsen", "", {}, {}, "key", 0});
  ASSERT_EQ(shown.size(), 1u);
  EXPECT_EQ(shown[0].value, "stretch.rms");
  EXPECT_EQ(shown[0].t, (std::vector<double>{0, 0.5}));
  EXPECT_EQ(shown[0].y, (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(shown[0].scene, "hang");
  table.rows.pop_back();
  EXPECT_TRUE(shown_series(table, {}).empty()) << "one moment is no curve";
}

}  // namespace
}  // namespace taut::report::findings_test
