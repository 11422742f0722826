// Results of other verbs in a results folder, as a report reads them.
#include "experiments/report/findings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/model/input_error.hpp"
#include "experiments/case/digest.hpp"
#include "experiments/report/questions/compared_solvers.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"
#include "experiments/truths/verification.hpp"
#include "tests/support/damaged_results.hpp"

namespace taut::report::findings_test {
namespace {

Finding finding(const std::string& subject, double expected, double tolerance, double measured,
                TruthVerdict verdict = TruthVerdict::passed, const std::string& unit = "m") {
  Finding f{subject, "", unit, measured, expected, tolerance};
  f.verdict = verdict;
  if (verdict != TruthVerdict::passed) f.why = "reasons >= pi";
  return f;
}

Truths truths_of(const std::vector<std::vector<Finding>>& findings) {
  const Scratch scratch;
  Verification all;
  all.assertions = {{"source", "1", "c", AssertionVerdict::holds, "f"}};
  for (const std::vector<Finding>& own : findings) {
    CheckedTruth& truth = all.truths.emplace_back();
    truth.name = "truth" + std::to_string(all.truths.size());
    truth.section_title = "S";
    truth.statement = "T^2";
    truth.source = "Q x 2";
    truth.findings = own;
  }
  Store store(scratch.path());
  store.keep(answer_of(all));
  EXPECT_FALSE(stored_truths(store, "another"));
  return *stored_truths(store, program_digest());
}

TEST(StoredTruths, ShowTheFindingNearestToItsTolerance) {
  const auto [shown, assertions] =
      truths_of({{finding("far", 1, 0.1, 1.02), finding("near", 1, 0.1, 0.92),
                  finding("apart", 1, 0.1, 1.5, TruthVerdict::deviates), finding("wide", 1, 1, 1.5),
                  finding("none", 1, 0.1, 1, TruthVerdict::not_applicable)},
                 {finding("exact", 2, 0, 2), finding("off", 2, 0, 2.5)},
                 {}});
  EXPECT_EQ(shown["truths"], 3);
  EXPECT_EQ(shown["findings"], 7);
  EXPECT_EQ(shown["verdicts"], (Json{{"deviates", 1}, {"not applicable", 1}, {"passed", 5}}));
  std::vector<std::string> subjects;
  for (const Json& row : shown["rows"]) subjects.push_back(row["subject"]);
  EXPECT_EQ(subjects, (std::vector<std::string>{"near", "apart", "none", "off"}));
  EXPECT_EQ(shown["rows"][1]["why"], "reasons ≥ π");
  EXPECT_EQ(shown["rows"][1]["verdict"], "deviates");
  EXPECT_EQ(shown["rows"][2]["expected"], "");
  EXPECT_EQ(shown["rows"][2]["measured"], "");
  EXPECT_EQ(shown["rows"][0], (Json{{"section", "S"},
                                    {"statement", "T²"},
                                    {"source", "Q × 2"},
                                    {"subject", "near"},
                                    {"expected", "1.00 ± 0.10 m"},
                                    {"measured", "0.92 m"},
                                    {"verdict", "passed"}}));
  EXPECT_EQ(assertions.at("c"), (std::pair<std::string, std::string>{"holds", "f"}));
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
        Written{2.5, 0, 2.5, "m/s^2", "exactly 2.50 m/s²", "2.50 m/s²"}}) {
    const Json rows = truths_of({{finding("x", one.expected, one.tolerance, one.measured,
                                          TruthVerdict::passed, one.unit)}})
                          .shown["rows"];
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0]["expected"], one.says) << one.tolerance;
    EXPECT_EQ(rows[0]["measured"], one.found) << one.tolerance;
  }
}

TEST(StoredFindings, AreThoseOfThisProgramAndNoneWithoutAny) {
  const Scratch scratch;
  Store store(scratch.path());
  const std::string p = program_digest();
  EXPECT_FALSE(stored_truths(store, p));
  EXPECT_FALSE(stored_regressions(store, p));
  EXPECT_TRUE(stored_requirements(store, p).empty());
  EXPECT_TRUE(stored_frontiers(store, p).empty());
  Answer check{"check"};
  check.add({"cases"}, 7);
  check.add({"values"}, 90);
  check.add(Table{"findings",
                  "",
                  {{"study"}, {"kind"}, {"case"}, {"change"}},
                  {{"s", "value moved", "c", "a -> b"}, {"s", "value new", "c", "is new"}}});
  store.keep(check);
  const auto found = stored_regressions(store, p);
  ASSERT_TRUE(found);
  EXPECT_EQ(*found, (Json{{"cases", 7},
                          {"values", 90},
                          {"rows", {{{"study", "s"}, {"case", "c"}, {"change", "a -> b"}}}}}));
  EXPECT_FALSE(stored_regressions(store, "q"));
  for (const char* scene : {"b", "a"}) {
    Answer one{"require", scene};
    for (const auto& [name, text] : std::vector<std::pair<const char*, const char*>>{
             {"scene", scene},
             {"solver", "xpbd:iterations=1"},
             {"chaotic", *scene == 'a' ? "no" : "late"},
             {"kept", "all"},
             {"can_go", "wind"},
             {"required", "pins"}})
      one.add({name}, text);
    if (*scene == 'a') one.add({"time_left"}, Interval{0.3, 0.34, 0.4});
    store.keep(one);
  }
  store.keep({"require", "c"});
  change(store, "UPDATE answers SET program = 'q' WHERE subject = 'c'");
  const auto required = stored_requirements(store, p);
  EXPECT_EQ(required, (Json{{"a", "XPBD", "no", "all", "wind", "pins", "34 %"},
                            {"b", "XPBD", "late", "all", "wind", "pins", "-"}}));
  store.keep({"check"});  // without numbers
  EXPECT_THROW(stored_regressions(store, p), InputError);
  change(store, "UPDATE answers SET answer = '{' WHERE kind = 'require'");
  EXPECT_THROW(stored_requirements(store, p), InputError);
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
  EXPECT_TRUE(spoiled([](Scene& s) { s.stiffness[0] = 500; })) << "the links' own stretch stays";
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

/// Stored study of two solvers, two numbers of sweeps and two time steps.
class StoredStudy : public testing::Test {
 protected:
  void SetUp() override {
    write_file(scratch_.path() / "s.toml",
               "summary = \"A strip\"\n[cloth]\ngrid = [4, 3]\nsize = [1, 0.5]\nmass = 0.1\npins = "
               "[0]\n[time]\ndt = \"1/64\"\nduration = 0.125\n");
    write_file(scratch_.path() / "few.toml",
               "question = \"How?\"\nscenes = [\"" + (scratch_.path() / "s.toml").string() +
                   "\"]\nsolvers = [\"jakobsen:substeps=1\", \"xpbd:substeps=1\"]\n"
                   "[axes]\niterations = [2, 16]\n\"time.dt\" = [\"1/64\", "
                   "\"1/32\"]\n[[plot]]\nkind = \"stability\"\n");
    study_ = load_study((scratch_.path() / "few.toml").string());
    cases_ = cases_of(study_);
    store_.prepare();
    run_cases(cases_, store_, {.jobs = 2});
  }
  const Scratch scratch_;
  Store store_{scratch_.path() / "results"};
  Study study_;
  std::vector<Case> cases_;
};

TEST_F(StoredStudy, IsReadWithItsPlanItsSlopeAndItsMotions) {
  ASSERT_EQ(cases_.size(), 8u);
  const ReportInput input = stored_results({study_}, store_);
  ASSERT_EQ(input.studies.size(), 1u);
  const StudyResult& study = input.studies[0];
  EXPECT_EQ(study.name + " " + study.question, "few How?");
  EXPECT_EQ(study.planned, 8u);
  EXPECT_EQ(study.slopes, (std::map<std::string, double>{{"s", -1}}));
  ASSERT_EQ(study.records.size(), 8u);
  ASSERT_EQ(input.scenes.size(), 1u);
  EXPECT_EQ(input.scenes[0].name + ": " + input.scenes[0].summary, "s: A strip");
  std::set<std::string> quoted;
  const ComparedSolvers compared = compared_solvers_of(input);
  for (const Record* r : compared.scenes.at(0).cases) {
    ASSERT_TRUE(r);
    EXPECT_EQ(r->dt, 1.0 / 64);
    EXPECT_EQ(r->sweeps, 16);
    quoted.insert(r->key);
  }
  ASSERT_EQ(quoted.size(), 2u);
  for (std::size_t i = 0; i < 8; ++i) {
    const Record &r = study.records[i], whole = *store_.find(cases_[i].key);
    EXPECT_EQ(r.key, cases_[i].key) << "in the plan's order";
    EXPECT_EQ(r.step_cost.empty(), !quoted.contains(r.key)) << "what few cases need";
    EXPECT_EQ(r.resolved_settings.empty(), !quoted.contains(r.key));
    EXPECT_EQ(r.digest, "");
    for (const auto& [name, value] : whole.values)
      EXPECT_TRUE(std::isfinite(value) ? r.values.at(name) == value : !r.values.contains(name));
  }
  std::set<std::string> shown;
  for (const TimeSeries& series : input.series) {
    EXPECT_TRUE(quoted.contains(series.key));
    EXPECT_EQ(series.label, series.solver == "xpbd" ? "XPBD" : "Jakobsen");
    if (series.value != "stretch.rms") continue;
    shown.insert(series.key);
    const Series table = store_.series(series.key);
    const auto column = [&](const char* name) {
      return static_cast<std::size_t>(std::ranges::find(table.columns, name) -
                                      table.columns.begin());
    };
    ASSERT_EQ(series.t.size(), table.rows.size());
    for (std::size_t k = 0; k < series.t.size(); ++k) {
      EXPECT_EQ(series.t[k], table.rows[k][column("t")]);
      EXPECT_EQ(series.y[k], table.rows[k][column("stretch.rms")]);
    }
  }
  EXPECT_EQ(shown, quoted);
  forget(store_, cases_[3].key);
  const ReportInput less = stored_results({study_}, store_);
  EXPECT_EQ(less.studies[0].planned, 8u);
  EXPECT_EQ(less.studies[0].records.size(), 7u);
}

TEST_F(StoredStudy, ItsMapsAndSeriesAreThoseOfItsRecords) {
  ReportInput input = stored_results({study_}, store_), empty;
  add_stored_maps(input, {study_}, store_);
  ASSERT_EQ(input.maps.size(), 1u);
  EXPECT_EQ(input.maps[0].study + " " + input.maps[0].question, "few How?");
  EXPECT_EQ(input.maps[0].x + " " + input.maps[0].y, "dt iterations");
  EXPECT_TRUE(input.maps[0].records.empty()) << "they are the study's";
  add_stored_maps(empty, {study_}, store_);
  ASSERT_EQ(empty.maps.size(), 1u);
  EXPECT_EQ(empty.maps[0].records.size(), 8u);
  Study other = study_;
  other.plots[0].options = {{"x", "iterations"}, {"y", "dt"}};
  add_stored_maps(empty, {other}, store_);
  EXPECT_EQ(empty.maps.at(1).x + " " + empty.maps[1].y, "iterations dt");
  other.plots[0].kind = "convergence";
  Study three = study_;
  three.axes.push_back(three.axes[0]);
  add_stored_maps(empty, {other, three}, store_);
  EXPECT_EQ(empty.maps.size(), 2u);
  Records records;
  for (const Record& r : input.studies[0].records)
    if (r.dt == 1.0 / 64) records.push_back(&r);
  const auto series = stored_series(records, "stretch.rms", store_);
  std::vector<std::string> labels;
  for (const TimeSeries& one : series) labels.push_back(one.label);
  EXPECT_EQ(labels, (std::vector<std::string>{"Jakobsen 1 × 2", "Jakobsen 1 × 16", "XPBD 1 × 2",
                                              "XPBD 1 × 16"}));
  EXPECT_EQ(series[1].key, records[1]->key);
  EXPECT_EQ(series[1].t.back(), 0.125);
  EXPECT_TRUE(stored_series(records, "no.such", store_).empty());
}

TEST_F(StoredStudy, IsComparedWithAnotherFolderCaseByCase) {
  Store other(scratch_.path() / "other");
  other.prepare();
  const auto put = [&](Record r, const std::string& key) {
    r.key = std::string(62, 'b') + key;
    other.commit(r);
  };
  std::vector<Record> all;
  for (const Case& one : cases_) all.push_back(*store_.find(one));
  for (std::size_t i = 1; i < 8;
       ++i) {  // the first is missing; the parameter is new in all cases of a solver
    Record r = all[i];
    r.values["stretch.rms"] *= 2;
    if (r.solver == "xpbd") r.params["new"] = "1";
    put(r, "0" + std::to_string(i));
    if (i == 7)  // two cases with the same name: neither is compared
    {
      r.params["new"] = "2";
      r.spec.solver += ",new=2";
      put(r, "19");
    }
  }
  Record alone = all[1];
  alone.spec.settings.push_back("cloth.mass=2");
  put(alone, "20");
  const Differences found = stored_differences(store_, other);
  EXPECT_EQ(found.a, store_.root().string());
  EXPECT_EQ(found.b, other.root().string());
  EXPECT_EQ(found.pairs.size(), 6u);
  for (const auto& [a, b] : found.pairs) {
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.dt, b.dt);
    EXPECT_EQ(b.values.at("stretch.rms"), 2 * a.values.at("stretch.rms"));
  }
  EXPECT_EQ(found.only_a, 2u);
  EXPECT_EQ(found.only_b, 3u);
  EXPECT_EQ(found.noise, 0);

  // A second build ran into this folder: the result stored last counts, whatever its key.
  for (const char* key : {"ff", "21"}) {
    Record r = all[3];
    r.values["stretch.rms"] = key[0] == 'f' ? 7 : 8;
    put(r, key);
  }
  const Differences again = stored_differences(store_, other);
  ASSERT_EQ(again.pairs.size(), 6u);
  EXPECT_EQ(again.only_a, 2u);
  EXPECT_EQ(again.only_b, 3u);
  const auto newest =
      std::ranges::find(again.pairs, all[3].id, [](const auto& p) { return p.first.id; });
  ASSERT_NE(newest, again.pairs.end());
  EXPECT_EQ(newest->second.value("stretch.rms"), 8);
  const ReportInput of_other = stored_anywhere({study_}, other);
  const auto shown = std::ranges::find(of_other.studies.at(0).records, all[3].id, &Record::id);
  ASSERT_NE(shown, of_other.studies[0].records.end());
  EXPECT_EQ(shown->value("stretch.rms"), 8);

  const ReportInput any = stored_anywhere({study_}, store_), none = stored_anywhere({}, store_);
  ASSERT_EQ(any.studies.size(), 1u);
  EXPECT_EQ(any.studies[0].name, "few");
  EXPECT_EQ(any.studies[0].records.size(), 8u);
  EXPECT_EQ(none.studies.at(0).name + " " + none.studies[0].question,
            "stored All cases of " + store_.root().string());
  EXPECT_EQ(none.studies[0].records.size(), 8u);
}

}  // namespace
}  // namespace taut::report::findings_test
