// Sentences of reports whose values are chosen for them.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "core/model/input_error.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/claims/claim.hpp"
#include "experiments/report/input.hpp"
#include "experiments/report/report.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report::sentences_test {
namespace {

/// One study of two solvers at 1 x 16 on these scenes.
class Reported {
 public:
  Record& add(const std::string& scene, const std::string& solver,
              const std::map<std::string, double>& values, double dt = 1.0 / 64) {
    Record r = synthetic::record(scene, solver, 16, dt);
    r.values = values;
    input.studies.front().records.push_back(r);
    return input.studies.front().records.back();
  }
  std::string sentence(const std::string& id) const {
    for (const Claim& claim : physics_claims(compared_solvers_of(input)))
      if (claim.id == id) return claim.sentence;
    return "";
  }
  ReportInput input{.studies = {{"one", "?", {}, 0, {}}}};
};

TEST(Sentences, ACaseThatFailedIsNamedOnceOneThatLacksAValueByTheValue) {
  Reported made;
  for (const char* scene : {"ball", "box"}) {
    made.add(scene, "jakobsen", {{"penetration.peak", 0.002}, {"face.peak", 0.003}});
    made.add(scene, "bullet", {{"penetration.peak", 0.001}, {"face.peak", 0.004}});
  }
  auto& records = made.input.studies.front().records;
  const std::string whole = made.sentence("depth");
  EXPECT_NE(whole.find("deepest of ball and box: Jakobsen 2.0\u00A0mm at a vertex (ball) and "
                       "3.0\u00A0mm at a face (ball); Bullet 1.0\u00A0mm at a vertex (ball) and "
                       "4.0\u00A0mm at a face (ball)."),
            std::string::npos)
      << whole;
  EXPECT_EQ(whole.find("Left out"), std::string::npos);
  records[3].values.erase("face.peak");
  std::string said = made.sentence("depth");
  EXPECT_TRUE(said.ends_with(" Left out: peak penetration of faces on box (Bullet has no value)."))
      << said;
  synthetic::fail(records[3], Status::Kind::exploded, "energy");
  said = made.sentence("depth");
  EXPECT_TRUE(said.ends_with(" Left out: box (Bullet ended as exploded).")) << said;
  EXPECT_NE(said.find("deepest of ball: "), std::string::npos) << said;
  records.pop_back();
  said = made.sentence("depth");
  EXPECT_TRUE(said.ends_with(" Left out: box (Bullet was not run like this).")) << said;
}

TEST(Sentences, TheDeepestOfSeveralScenesIsNamedAndPassagesAreSummed) {
  Reported made;
  made.add("ball", "jakobsen", {{"penetration.peak", 0.002}, {"tunnelling.events", 3}});
  made.add("ball", "bullet", {{"penetration.peak", 0.0}, {"tunnelling.events", 0}});
  made.add("box", "jakobsen", {{"penetration.peak", 0.005}, {"tunnelling.events", 4}});
  made.add("box", "bullet", {{"penetration.peak", 0.0}, {"tunnelling.events", 1}});
  const std::string said = made.sentence("depth");
  EXPECT_NE(said.find("Jakobsen 5.0\u00A0mm at a vertex (box); Bullet 0\u00A0mm at a vertex; faces "
                      "were not measured; passages of vertices through a collider: Jakobsen 7, "
                      "Bullet 1."),
            std::string::npos)
      << said;
}

TEST(Sentences, SettingsOfASceneAreSaidWhereTheyDiffer) {
  Reported made;
  for (const char* grid : {"cloth.grid=[4, 4]", "cloth.grid=[8, 8]"})
    for (const char* solver : {"jakobsen", "bullet"})
      made.add("hang", solver, {{"stretch.rms", 0.02}, {"penetration.peak", 0.002}})
          .spec.overrides = {grid[12] == '4' ? "time.duration=2" : "time.duration=3", grid};
  for (const char* solver : {"jakobsen", "bullet"})
    made.add("ball", solver, {{"stretch.rms", 0.02}, {"penetration.peak", 0.003}})
        .spec.overrides = {"time.duration=2"};
  for (std::size_t i = 0; Record & r : made.input.studies.front().records)
    r.key = std::to_string(i++);
  EXPECT_NE(made.sentence("stretch").find("geometric mean over hang (cloth.grid=[4, 4]) and ball"),
            std::string::npos)
      << made.sentence("stretch");
  EXPECT_NE(made.sentence("depth").find("deepest of hang (cloth.grid=[4, 4]) and ball"),
            std::string::npos)
      << made.sentence("depth");
  EXPECT_NE(made.sentence("stretch-hang").find(" on hang (cloth.grid=[4, 4]) at 1 × 16"),
            std::string::npos)
      << made.sentence("stretch-hang");
  EXPECT_EQ(made.sentence("stretch-ball").find(" on ball"), std::string::npos);
  const ComparedSolvers compared = compared_solvers_of(made.input);
  ASSERT_EQ(compared.scenes.size(), 2u);
  for (const std::string scene : {"hang", "ball"}) {
    ASSERT_TRUE(compared.quoted(scene)) << "by its name, as pages and films ask";
    EXPECT_EQ(compared.quoted(compared.quoted(scene)->title), compared.quoted(scene));
  }
}

TEST(Sentences, WhoHasLessIsSaidBeyondFivePerCentOnly) {
  Reported made;
  for (const auto& [scene, a, b] : {std::tuple{"ball", 0.02, 0.04},
                                    {"box", 0.03, 0.01},
                                    {"hang", 0.02, 0.0209},
                                    {"free", 0.02, 0.0211},
                                    {"rest", 1e-5, 9e-4},
                                    {"still", 1e-5, 2e-3}}) {
    made.add(scene, "jakobsen", {{"stretch.rms", a}});
    made.add(scene, "bullet", {{"stretch.rms", b}});
  }
  const std::string said = made.sentence("stretch");
  EXPECT_NE(said.find(" Less with Jakobsen on ball, free and still. Less with Bullet on box. "
                      "Within 5\u00A0% of each other on hang. Below 0.1\u00A0% with all on rest."),
            std::string::npos)
      << said;
}

TEST(Sentences, ALargestStepIsUpToTheFirstThatFails) {
  Reported made;
  for (const char* solver : {"jakobsen", "bullet"})
    for (const double dt : {0.004, 0.008, 0.016, 0.032}) made.add("ball", solver, {}, dt);
  auto& records = made.input.studies.front().records;
  EXPECT_NE(
      made.sentence("step").find("on ball (4.00\u00A0ms to 32.0\u00A0ms tried, each at 1 × 16) "
                                 "Jakobsen 32.0\u00A0ms (the largest tried) and Bullet "
                                 "32.0\u00A0ms (the largest tried)."),
      std::string::npos)
      << made.sentence("step");
  synthetic::fail(records[6], Status::Kind::exploded, "energy");  // of Bullet at 16 ms
  records[1].status.kind = Status::Kind::unsettled;
  EXPECT_NE(made.sentence("step").find("Jakobsen 32.0\u00A0ms (the largest tried) and Bullet "
                                       "8.00\u00A0ms."),
            std::string::npos)
      << made.sentence("step");
  synthetic::fail(records[4], Status::Kind::timeout, "60 s");
  EXPECT_NE(made.sentence("step").find("and Bullet none."), std::string::npos);
  EXPECT_EQ(made.sentence("failures"),
            "Cases that failed: Jakobsen none of 4 and Bullet 2 of 4 (1 exploded, 1 timeout). "
            "Counted in the study one.");
  // Two steps, and three that lie close together, are no map.
  Reported few, narrow, wide;
  for (const char* solver : {"jakobsen", "bullet"}) {
    for (const double dt : {0.004, 0.032}) few.add("ball", solver, {}, dt);
    for (const double dt : {0.004, 0.008, 0.015}) narrow.add("ball", solver, {}, dt);
    for (const double dt : {0.004, 0.008, 0.016}) wide.add("ball", solver, {}, dt);
  }
  EXPECT_EQ(few.sentence("step"), "");
  EXPECT_EQ(narrow.sentence("step"), "");
  EXPECT_NE(wide.sentence("step"), "");
}

TEST(Caveats, CountThePlannedCasesThatWereNotRun) {
  ReportInput input{.studies = {{"one", "?", {}, 3, {}}, {"two", "?", {}, 0, {}}}};
  input.studies[0].records.resize(1), input.studies[1].records.resize(5);
  EXPECT_EQ(caveats(input).back(), "The 2 planned cases that have not been run.");
  input.studies[0].records.resize(3);
  EXPECT_EQ(caveats(input).size(), 5u);
  EXPECT_NE(caveats(input).front().find("taut bench measures"), std::string::npos);
  input.bench = StudyBench{"trade", "a machine", {}};
  EXPECT_NE(caveats(input).front().find("(a machine)"), std::string::npos);
}

}  // namespace
}  // namespace taut::report::sentences_test
