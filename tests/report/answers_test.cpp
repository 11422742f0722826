// The answer of results whose values are chosen; answer_test.py makes every cell of made-up ones
// again.
#include <gtest/gtest.h>

#include "experiments/report/answer/answer.hpp"
#include "experiments/report/input.hpp"
#include "experiments/study/study.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report::answers_test {
namespace {

/// One study of two solvers at 1 x 16.
struct Reported {
  Record& add(const std::string& scene, const std::string& solver,
              const std::map<std::string, double>& values) {
    Record r = synthetic::record(scene, solver, 16, 1.0 / 64);
    r.values = values;
    return input.studies.front().records.emplace_back(r);
  }
  Answer answer() const {
    CaseList list(input);
    return answer_of(input, compared_solvers_of(input), list);
  }
  ReportInput input{.studies = {{"one", "?", {}, 0, {}}}};
};

TEST(PageAnswers, HaveAValueOrWhyThereIsNoneAndMarkWhatIsBetterByMoreThanTheTolerance) {
  Reported made;
  const auto stretch = [&](const std::string& scene, const char* solver, double value) -> Record& {
    return made.add(scene, solver, {{"stretch.rms", value}});
  };
  stretch("hang", "jakobsen", 0.04), stretch("hang", "bullet", 0.01);
  stretch("ball", "jakobsen", 0.0100), stretch("ball", "bullet", 0.0104);
  stretch("box", "jakobsen", 0.02);
  stretch("box", "bullet", 1e-9).status = {Status::Kind::exploded, "energy", 3, 1};
  stretch("drape", "jakobsen", 1e-12), stretch("drape", "bullet", 1e-5);
  stretch("swing", "jakobsen", 0.03);
  const Answer answer = made.answer();
  const Table& table = answer.table("stretch.rms");
  ASSERT_EQ(table.rows.size(), 6u);
  const auto best = [&](std::size_t row) {
    return std::pair(bool(table.rows[row][1].best), bool(table.rows[row][2].best));
  };
  EXPECT_EQ(best(0), std::pair(false, true));
  EXPECT_EQ(best(1), std::pair(false, false)) << "within the tolerance";
  EXPECT_EQ(table.rows[2][2].text(), "exploded");
  EXPECT_EQ(best(2), std::pair(false, false)) << "alone";
  EXPECT_EQ(best(3), std::pair(false, false)) << "both as good as nothing";
  EXPECT_EQ(table.rows[4][2].text(), "not run");
  EXPECT_EQ(table.rows[5][0].text(), "mean of 2 scenes");
  EXPECT_EQ(table.rows[5][0].note, "without box, drape, swing");
  EXPECT_NEAR(table.rows[5][1].number(), 0.02, 1e-12);
  EXPECT_NEAR(table.rows[5][2].number(), std::sqrt(0.01 * 0.0104), 1e-12);
  EXPECT_EQ(best(5), std::pair(false, true));
  const Table& failures = answer.table("failures");
  EXPECT_EQ(failures.rows.back()[1].number(), 0);
  EXPECT_EQ(failures.rows.back()[2].number(), 1);
  EXPECT_EQ(failures.rows.back()[2].note, "of 4: 1 exploded");
}

TEST(PageAnswers, SayTheDeepestOfTheWholeRunAndWhatASolverCannot) {
  Reported made;
  for (const char* scene : {"ball", "box"}) {
    made.add(scene, "jakobsen", {{"penetration.peak", 0.002}, {"penetration.max", 0}});
    made.add(scene, "bullet", {{"penetration.peak", 0.005}, {"penetration.max", 1}});
    made.add(scene, "xpbd", {}).status = {Status::Kind::unsupported, "no balls", -1, -1};
  }
  made.input.studies[0].records[4].values["penetration.peak"] = 0.03;
  const Answer answer = made.answer();
  const auto& last = answer.table("penetration.peak").rows.back();
  EXPECT_EQ(last[0].text(), "largest of 2 scenes");
  EXPECT_EQ(last[1].number(), 0.002);
  EXPECT_EQ(last[2].number(), 0.03);
  EXPECT_EQ(last[3].text(), "cannot: no balls");
  EXPECT_FALSE(last[3].best);
  EXPECT_TRUE(last[1].best);
  EXPECT_EQ(answer.table("failures").rows.back()[3].number(), 0) << "no failure";
}

TEST(PageAnswers, MarkACostOnlyBeyondWhatIdenticalCodeDiffersBy) {
  Reported made;
  const Record& ours = made.add("hang", "jakobsen", {{"stretch.rms", 0.005}});
  const Record cheap = ours;
  Record dear = made.add("hang", "bullet", {{"stretch.rms", 0.004}});
  dear.params["iterations"] = "1";  // nothing is cheaper: its cost is no upper bound
  const auto price = [&](double ratio, double noise) {
    const std::vector<double> one(12, 1e-3), other(12, 1e-3 * ratio);
    made.input.bench =
        StudyBench{"one",
                   "a machine",
                   {{"hang",
                     {1 / (1 + noise), 1, 1 + noise},
                     {{cheap, {one, one, 0, "", ""}}, {dear, {other, other, 0, "", ""}}}}}};
    return made.answer().table("price").rows[0];
  };
  EXPECT_TRUE(price(1.3, 0.02)[1].best);
  EXPECT_FALSE(price(1.3, 0.4)[1].best) << "noise";
  EXPECT_FALSE(price(1.03, 0.001)[1].best) << "the tolerance";
  EXPECT_NEAR(price(1.3, 0.02)[2].number(), 1.3e-3 * 64, 1e-9);
}

/// A bench of hang: solver, substeps, sweeps, error, CPU time of a step [s].
struct Timed {
  const char *scene, *solver;
  int substeps, sweeps;
  double error, cpu;
};
StudyBench bench_of(const std::vector<Timed>& all) {
  StudyBench bench{"one", "a machine", {}};
  for (const auto& [scene, solver, substeps, sweeps, error, cpu] : all) {
    if (bench.scenes.empty() || bench.scenes.back().scene != scene)
      bench.scenes.push_back({scene, {0.99, 1, 1.01}, {}});
    Record r = synthetic::record(scene, solver, sweeps, 1.0 / 64);
    r.params["substeps"] = std::to_string(substeps);
    r.spec.solver += ",substeps=" + std::to_string(substeps);
    r.id += r.spec.solver, r.key += std::to_string(substeps) + "x" + std::to_string(sweeps);
    r.values = {{"stretch.rms", error}};
    const std::vector<double> samples(12, cpu);
    bench.scenes.back().cases.push_back({r, {samples, samples, 0, "", ""}});
  }
  return bench;
}

TEST(PageAnswers, SayThatACostIsAnUpperBoundWhereNothingCheaperWasTried) {
  Reported made;
  made.add("hang", "jakobsen", {{"stretch.rms", 0.005}});
  made.add("hang", "pd", {{"stretch.rms", 0.005}});
  std::vector<Timed> timed{{"hang", "jakobsen", 1, 1, 0.5, 1e-5},
                           {"hang", "jakobsen", 20, 1, 0.005, 1e-4},
                           {"hang", "pd", 8, 1, 0.0003, 1e-3},
                           {"hang", "pd", 16, 1, 0.0001, 2e-3}};
  const auto cells = [&](const char* table) {
    made.input.bench = bench_of(timed);
    return made.answer().table(table).rows[0];
  };
  EXPECT_EQ(cells("price")[2].note, "8 × 1; at most: its cheapest setting tried");
  EXPECT_FALSE(cells("price")[1].best) << "PD may be cheaper than this";
  EXPECT_EQ(cells("setting")[2].note, "at most 64\u00A0ms");
  EXPECT_FALSE(cells("setting")[1].best);
  timed.push_back({"hang", "pd", 1, 1, 0.5, 1.1e-3});
  EXPECT_EQ(cells("price")[2].note, "8 × 1; at most: its cheapest setting tried") << "dearer";
  timed.back().cpu = 5e-4;
  EXPECT_EQ(cells("price")[2].note, "8 × 1");
  EXPECT_TRUE(cells("price")[1].best);
  timed.back().error = 0.003;
  EXPECT_EQ(cells("price")[2].note, "1 × 1") << "nothing is cheaper";
}

TEST(PageAnswers, MarkNoSettingOfSolversThatReachTheErrorOnDifferentScenes) {
  Reported made;
  for (const char* solver : {"jakobsen", "bullet"})
    made.add("hang", solver, {{"stretch.rms", 0.1}});
  std::vector<Timed> timed{{"hang", "jakobsen", 1, 1, 0.005, 1e-5},
                           {"hang", "bullet", 1, 1, 0.005, 1e-3},
                           {"ball", "jakobsen", 1, 1, 0.005, 1e-5},
                           {"ball", "bullet", 1, 1, 0.005, 1e-3}};
  const auto last = [&] {
    made.input.bench = bench_of(timed);
    return made.answer().table("setting").rows.back();
  };
  EXPECT_TRUE(last()[1].best);
  timed[3].error = 0.5;
  EXPECT_FALSE(last()[1].best) << "Bullet reaches it on one scene alone";
  EXPECT_NE(last()[2].note.find("1 of 2"), std::string::npos);
}

TEST(TheStudyOfTrade, BeginsWithTheCheapestSettingOfEverySolverAndHasAsManyOfEach) {
  for (const char* preset : {"quick", ""}) {
    std::map<std::string, int> settings, cheapest;
    for (const std::string& text : load_study("trade", preset).solvers) {
      const SolverChoice choice = parse_solver(text);
      const std::string solver(choice.entry->name);
      const auto one = [&](std::string_view name) {
        return name.empty() || !choice.params.has(name) || choice.params.integer(name) <= 1;
      };
      ++settings[solver];
      cheapest[solver] +=
          one(choice.entry->accuracy.substeps) && one(choice.entry->accuracy.sweeps);
    }
    for (const auto& [solver, n] : settings) {
      if (solver == "bullet-deformable") continue;  // its Newton iterations are not varied
      EXPECT_GE(cheapest[solver], 1) << solver << ", preset " << preset;
      EXPECT_TRUE(!*preset || n == settings.at("jakobsen")) << solver;
    }
  }
}

}  // namespace
}  // namespace taut::report::answers_test
