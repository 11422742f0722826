// Answers from results with chosen values; answer_test.py recomputes every cell for made-up
// results.
#include "experiments/report/questions/questions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/io/scene_io.hpp"
#include "core/model/solver.hpp"
#include "core/model/text.hpp"
#include "experiments/report/input.hpp"
#include "experiments/report/questions/costs.hpp"
#include "experiments/report/questions/failure_map.hpp"
#include "experiments/report/questions/links.hpp"
#include "experiments/report/questions/winners.hpp"
#include "experiments/study/study.hpp"
#include "experiments/system/data.hpp"
#include "experiments/timing/judge.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report::questions_test {
namespace {

/// A study of two solvers at 1 x 16.
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

// Sweeps of two solvers cost differently: no solver is marked best.
TEST(PageAnswers, HaveAValueOrAReasonAndMarkNobody) {
  Reported made;
  const auto stretch = [&](const std::string& scene, const char* solver, double value) -> Record& {
    return made.add(scene, solver, {{"stretch.rms", value}});
  };
  stretch("hang", "jakobsen", 0.04);
  stretch("hang", "bullet", 0.01);
  stretch("ball", "jakobsen", 0.0100);
  stretch("ball", "bullet", 0.0104);
  stretch("box", "jakobsen", 0.02);
  stretch("box", "bullet", 1e-9).status = {Status::Kind::exploded, Reason::energy, 3, 1};
  stretch("drape", "jakobsen", 1e-12);
  stretch("drape", "bullet", 1e-5);
  stretch("swing", "jakobsen", 0.03);
  const Answer answer = made.answer();
  const Table& table = answer.table("stretch.rms");
  ASSERT_EQ(table.rows.size(), 6u);
  EXPECT_EQ(table.title, "RMS stretch at equal sweeps");
  for (const auto& row : table.rows)
    for (const Cell& cell : row) EXPECT_FALSE(cell.best);
  EXPECT_EQ(table.rows[2][2].text(), "exploded");
  EXPECT_EQ(table.rows[4][2].text(), "not run");
  EXPECT_EQ(table.rows[4][2].state, Cell::State::not_run);
  EXPECT_EQ(table.rows[5][0].text(), "mean of 2 scenes");
  EXPECT_EQ(table.rows[5][0].note, "without box, drape, swing");
  EXPECT_NEAR(table.rows[5][1].number(), 0.02, 1e-12);
  EXPECT_NEAR(table.rows[5][2].number(), std::sqrt(0.01 * 0.0104), 1e-12);
  const Table& failures = answer.table("failures");
  EXPECT_EQ(failures.rows.back()[1].number(), 0);
  EXPECT_EQ(failures.rows.back()[2].number(), 1);
  EXPECT_EQ(failures.rows.back()[2].note, "of 4: 1 exploded");
  EXPECT_EQ(failures.rows.back()[0].text(), "sum of 4 scenes") << "Bullet did not run swing";
}

TEST(PageAnswers, SayTheDeepestOfTheWholeRun) {
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
  EXPECT_EQ(last[3].state, Cell::State::refused);
  EXPECT_FALSE(last[1].best) << "a step of Bullet may cost less";
  EXPECT_EQ(answer.table("failures").rows.back()[3].number(), 0) << "no failure";
}

// A note says what small values count as, and only where a mean includes values that may be zero.
TEST(PageAnswers, SayWhatLessCountsAsWhereAMeanTakesItSo) {
  Reported made;
  for (const char* scene : {"ball", "swing"})
    for (const char* solver : {"jakobsen", "bullet"})
      made.add(scene, solver,
               {{"stretch.rms", 0.01}, {"penetration.peak", 0.002}, {"motion.share", 0.5}});
  made.input.studies[0].records.back().dt = 1.0 / 32;
  const Answer answer = made.answer();
  const auto caption = [&](const char* table) { return answer.table(table).caption; };
  for (const char* table : {"stretch.rms", "penetration.peak", "motion.share"})
    EXPECT_EQ(caption(table).find("less than") != std::string::npos,
              table == std::string("stretch.rms"))
        << caption(table);
  EXPECT_NE(caption("stretch.rms").find("; less than 0.1\u00A0% counts as 0.1\u00A0%"),
            std::string::npos)
      << caption("stretch.rms");
}

TEST(PageAnswers, MarkACostOnlyBeyondWhatIdenticalCodeDiffersBy) {
  Reported made;
  const Record& ours = made.add("hang", "jakobsen", {{"stretch.rms", 0.005}});
  const Record cheap = ours;
  Record dear = made.add("hang", "bullet", {{"stretch.rms", 0.004}});
  dear.sweeps = 1;  // nothing is cheaper, so that its cost is not an upper bound
  const auto price = [&](double ratio, double noise) {
    const std::vector<double> one(12, 1e-3), other(12, 1e-3 * ratio);
    made.input.bench =
        StudyBench{"one",
                   "a machine",
                   {{"hang",
                     {1 / (1 + noise), 1, 1 + noise},
                     {{cheap, {one, one, 0, "", ""}}, {dear, {other, other, 0, "", ""}}},
                     true,
                     std::vector<Limit>{}}}};
    return made.answer().table("price").rows[0];
  };
  EXPECT_TRUE(price(1.3, 0.02)[1].best);
  EXPECT_FALSE(price(1.3, 0.4)[1].best) << "noise";
  EXPECT_FALSE(price(1.03, 0.001)[1].best) << "the tolerance";
  EXPECT_NEAR(price(1.3, 0.02)[2].number(), 1.3e-3 * 64, 1e-9);
}

/// Timed case of hang: solver, substeps, sweeps, error, CPU time of a step [s].
struct Timed {
  const char *scene, *solver;
  int substeps, sweeps;
  double error, cpu;
};
StudyBench bench_of(const std::vector<Timed>& all) {
  StudyBench bench{"one", "a machine", {}};
  for (const auto& [scene, solver, substeps, sweeps, error, cpu] : all) {
    if (bench.scenes.empty() || bench.scenes.back().scene != scene)
      bench.scenes.push_back({scene, {0.99, 1, 1.01}, {}, true, std::vector<Limit>{}});
    Record r = synthetic::record(scene, solver, sweeps, 1.0 / 64);
    r.substeps = substeps;
    r.spec.solver += ",substeps=" + std::to_string(substeps);
    r.id += r.spec.solver;
    r.key += std::to_string(substeps) + "x" + std::to_string(sweeps);
    r.values = {{"stretch.rms", error}, {"motion.error", error}};
    const std::vector<double> samples(12, cpu);
    bench.scenes.back().cases.push_back({r, {samples, samples, 0, "", ""}});
  }
  return bench;
}

TEST(PageAnswers, SayThatACostIsAnUpperBound) {
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
  EXPECT_EQ(cells("price")[2].note, "8 × 1; at most");
  EXPECT_FALSE(cells("price")[1].best) << "PD may be cheaper than this";
  EXPECT_TRUE(made.answer().table("price").caption.ends_with(
      "; at most: no cheaper setting of that solver was tried"));
  EXPECT_EQ(cells("setting")[2].note, "at most 64\u00A0ms");
  EXPECT_FALSE(cells("setting")[1].best);
  timed.push_back({"hang", "pd", 1, 1, 0.5, 1.1e-3});
  EXPECT_EQ(cells("price")[2].note, "8 × 1") << "less work was tried, and was dearer";
  timed.back().cpu = 5e-4;
  EXPECT_EQ(cells("price")[2].note, "8 × 1");
  EXPECT_TRUE(cells("price")[1].best);
  timed.back().error = 0.003;
  EXPECT_EQ(cells("price")[2].note, "1 × 1") << "nothing is cheaper";
}

TEST(PageAnswers, MarkNoSettingWhereScenesDiffer) {
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

TEST(PageAnswers, ClothThatIsElsewhereIsNeverBestAndInNoMean) {
  Reported made;
  const auto add = [&](const char* scene, const char* solver, double stretch, double motion) {
    made.add(scene, solver, {{"stretch.rms", stretch}, {"motion.error", motion}});
  };
  add("swing", "jakobsen", 0.03, 0.1);
  add("swing", "bullet", 0.02, 0.49);
  add("swing", "vbd", 0.001, 0.51);
  add("hang", "jakobsen", 0.05, std::nan(""));
  add("hang", "bullet", 0.04, std::nan(""));
  add("hang", "vbd", 0.03, std::nan(""));
  Answer answer = made.answer();
  const Table& table = answer.table("stretch.rms");
  EXPECT_EQ(table.rows[0][3].note, astray(made.input.studies[0].records[2]));
  EXPECT_FALSE(table.rows[0][3].note.empty());
  EXPECT_EQ(table.rows[0][3].state, Cell::State::astray);
  EXPECT_EQ(table.rows[0][0].scene, "swing");
  EXPECT_EQ(table.rows.back()[0].scene, "") << "of all together";
  EXPECT_EQ(table.rows[2][0].note, "without swing");
  EXPECT_EQ(table.rows[2][3].number(), 0.03);
  EXPECT_TRUE(answer.table("motion.error").rows[0][3].note.empty());

  made.input.bench = bench_of({{"swing", "jakobsen", 1, 1, 0.005, 1e-3},
                               {"swing", "vbd", 1, 1, 0.005, 1e-5},
                               {"swing", "vbd", 8, 1, 0.004, 1e-4}});
  auto& cases = made.input.bench->scenes[0].cases;
  const auto row = [&] { return made.answer().table("price").rows[0]; };
  cases[1].record.values["motion.error"] = 0.6;
  EXPECT_EQ(row()[3].note, "8 × 1") << "the cheapest that is where it should be";
  EXPECT_TRUE(row()[3].best);
  cases[2].record.values["motion.error"] = 0.6;
  EXPECT_EQ(row()[3].text(), "not reached");
  EXPECT_EQ(row()[3].note, "at best 60 % (vbd:iterations=1)");
  EXPECT_FALSE(row()[1].best) << "alone";
  cases[2].record.values["motion.error"] = 0.06;
  EXPECT_EQ(row()[3].text(), "not reached");
  EXPECT_EQ(row()[3].note, "at best 6 % (vbd:iterations=1,substeps=8)");
  cases[2].record.values["motion.error"] = 0.04;
  EXPECT_EQ(row()[3].note, "8 × 1");
  cases[2].record.values["stretch.rms"] = 0.06;
  EXPECT_EQ(row()[3].text(), "not reached") << "strained";
  cases[2].record.values["motion.strain"] = 0.03;
  EXPECT_EQ(row()[3].note, "8 × 1") << "as the reference is";
  cases[2].record.values["motion.floor"] = 0.02;
  EXPECT_EQ(row()[3].text(), "not reached") << "below three floors nothing is known";
}

// Where work is unequal each cell states its own, in addition to its other notes.
TEST(PageAnswers, ClothThatIsElsewhereIsNotBestAtUnequalWork) {
  Reported made;
  made.add("swing", "jakobsen", {{"stretch.rms", 0.03}, {"motion.error", 0.1}});
  Record& still = made.add("swing", "vbd", {{"stretch.rms", 0.001}, {"motion.error", 0.51}});
  still.sweeps = 8;
  const std::string where = astray(still);
  const auto row = made.answer().table("stretch.rms").rows[0];
  EXPECT_EQ(row[1].note, "1 × 16");
  EXPECT_EQ(row[2].note, where + "; 1 × 8");
  EXPECT_FALSE(row[2].best);
}

// Settings that reach the error on most scenes come first; among those the cheapest, in any order.
TEST(PageAnswers, RecommendWhatReachesTheErrorOnMostScenes) {
  Reported made;
  for (const char* solver : {"jakobsen", "bullet"})
    made.add("hang", solver, {{"stretch.rms", 0.1}});
  for (const double reached : {0.005, 0.5})
    for (const bool cheap_first : {true, false}) {
      std::vector<Timed> timed;
      for (const char* scene : {"hang", "ball"}) {
        const double error = scene == std::string("ball") ? reached : 0.005;
        const Timed cheap{scene, "jakobsen", 1, 2, error, 1e-4},
            dear{scene, "jakobsen", 1, 8, 0.004, 4e-4};
        timed.insert(timed.end(), {cheap_first ? cheap : dear,
                                   cheap_first ? dear : cheap,
                                   {scene, "bullet", 1, 1, 0.005, 1e-3}});
      }
      made.input.bench = bench_of(timed);
      EXPECT_EQ(made.answer().table("setting").rows.back()[1].text(),
                reached < 0.01 ? "1 × 2" : "1 × 8");
    }
}

TEST(PageAnswers, CountFailuresOfWhatAllSolversRanAlone) {
  Reported made;
  const auto add = [&](const char* solver, int sweeps, bool fails) {
    Record r = synthetic::record("hang", solver, sweeps, 1.0 / 64);
    if (fails) synthetic::fail(r, Status::Kind::exploded, Reason::energy);
    made.input.studies.front().records.push_back(r);
  };
  add("jakobsen", 1, true);
  add("jakobsen", 2, true);
  add("jakobsen", 16, false);
  add("bullet", 1, true);
  add("bullet", 16, false);
  const Answer answer = made.answer();
  const auto& row = answer.table("failures").rows[0];
  EXPECT_EQ(row[1].number(), 1) << "not those that Bullet was not asked";
  EXPECT_EQ(row[1].note, "of 2: 1 exploded");
  EXPECT_EQ(row[2].note, "of 2: 1 exploded");
  EXPECT_NE(answer.table("failures").caption.find("of all 5 cases of this page, 3 failed"),
            std::string::npos);
}

TEST(PageAnswers, TheLargestStepSaysAtWhichWork) {
  Reported made;
  for (const char* solver : {"jakobsen", "bullet"})
    for (const int sweeps : {1, 4, 16})
      for (const double dt : {0.001, 0.01, 0.1})
        made.input.studies.front().records.push_back(synthetic::record("hang", solver, sweeps, dt));
  const Answer answer = made.answer();
  for (const auto& row : answer.table("largest_step").rows)
    EXPECT_EQ(row[0].note, "at 1, 4 and 16 sweeps");
}

TEST(PageAnswers, SayInWhatArithmeticAndOrderLinksAreSolved) {
  Record r = synthetic::record("hang", "jakobsen", 1, 1.0 / 64);
  EXPECT_EQ(arithmetic_of(r, "avx2").text(), "double");
  r.params = {{"precision", "float"}, {"simd", "scalar"}};
  EXPECT_EQ(arithmetic_of(r, "avx2").text(), "float, scalar");
  r.params["simd"] = "auto";
  EXPECT_EQ(arithmetic_of(r, "avx2").text(), "float × 8 (avx2)");
  EXPECT_EQ(arithmetic_of(r, "avx2").brief(), "float × 8");
  EXPECT_EQ(arithmetic_of(r, "avx2").meaning(), "single precision, 8 numbers in one instruction");
  EXPECT_EQ(arithmetic_of(r, "").text(), "float, vectors");
  r.params["precision"] = "double";
  EXPECT_EQ(arithmetic_of(r, "avx512").text(), "double × 8 (avx512)");
  r.params = {{"simd", "auto"}};
  EXPECT_EQ(arithmetic_of(r, "avx2").text(), "double") << "no kernels of its own precision";
  EXPECT_EQ(link_order(r), "");
  r.resolved_settings.emplace_back(kLinkOrder, "the scene's", "mesh order");
  EXPECT_EQ(link_order(r), "mesh order");
  r.resolved_settings.back() = {kLinkOrder, "as its program says"};
  EXPECT_EQ(link_order(r), "as its program says");

  Reported made;
  made.add("hang", "jakobsen", {{"stretch.rms", 0.1}});
  made.add("hang", "bullet", {});
  made.input.bench =
      bench_of({{"hang", "jakobsen", 20, 1, 0.005, 1e-3}, {"hang", "bullet", 1, 1, 0.005, 1e-3}});
  auto& cases = made.input.bench->scenes[0].cases;
  cases[0].record.resolved_settings = {{"link order", "coloured"}};
  cases[0].record.params["order"] = "coloured";
  cases[1].record.resolved_settings = {{kLinkOrder, "the scene's", "mesh order"}};
  cases.push_back(cases[0]);  // more expensive
  for (double& sample : cases[2].timing.samples) sample *= 2;
  cases[2].record.params["order"] = "mesh";
  cases[2].record.resolved_settings = cases[1].record.resolved_settings;
  const Answer answer = made.answer();
  const Table& price = answer.table("price");
  EXPECT_NE(price.caption.find("Jakobsen coloured, Bullet mesh order"), std::string::npos);
  EXPECT_EQ(price.rows[0][1].note, "20 × 1, coloured; at most");
  EXPECT_EQ(price.rows[0][2].note, "1 × 1, mesh order");
  EXPECT_EQ(price.rows[0][1].terms, (std::vector<std::string>{kWorkTerm, "coloured"}));
  EXPECT_EQ(setting_label(made.input.bench->scenes[0], 2).text(), "20 × 1, mesh order")
      << "its order is said once";
}

/// Records of a solver: the defaults, and one more whose parameter has another value.
std::vector<Record> with_another_value(const SolverEntry& entry, const ParamSpec& spec) {
  const Params defaults(entry.name, entry.params, "");
  Record first = synthetic::record("hang", std::string(entry.name), 1, 1.0 / 64), second = first;
  const std::string name(spec.name), usual(defaults.value(name));
  std::string other = "0.125";
  for (const std::string& choice : parts_of(spec.choices))
    if (choice != usual) other = choice;
  first.params[name] = usual;
  second.params[name] = other;
  return {first, second};
}

std::map<std::string, std::string> meanings(const std::vector<Record>& all) {
  const auto terms = terms_of(Records(all), "");
  return {terms.begin(), terms.end()};
}

TEST(Terms, ExplainEveryParameterThatALabelNamesByItsOwnSolver) {
  std::vector<Record> all;
  std::vector<std::pair<std::string, const ParamSpec*>> named;  // a label's term, and of what
  for (const SolverEntry* entry : solvers())
    for (const std::string& name : labelled_parameters(std::string(entry->name))) {
      const ParamSpec& spec = *std::ranges::find(entry->params, name, &ParamSpec::name);
      const std::vector<Record> two = with_another_value(*entry, spec);
      const Label label = SettingLabels(two).parts(two[1]);
      ASSERT_EQ(label.terms().size(), 1u) << entry->name << " " << name;
      named.emplace_back(label.terms()[0], &spec);
      all.insert(all.end(), two.begin(), two.end());
    }
  const auto found = meanings(all);
  for (const auto& [term, spec] : named) {
    ASSERT_TRUE(found.contains(term)) << term;
    EXPECT_TRUE(found.at(term).starts_with(spec->help)) << term << ": " << found.at(term);
  }
}

TEST(Terms, NameTheSolverWhereOthersMeanSomethingElseAndSayUnitsAndChoices) {
  std::vector<Record> all;
  for (const auto& [solver, name] : {std::pair("jakobsen", "tethers"),
                                     {"bullet", "stiffness"},
                                     {"bullet-deformable", "stiffness"}})
    for (const SolverEntry* entry : solvers())
      if (entry->name == solver)
        for (Record& r :
             with_another_value(*entry, *std::ranges::find(entry->params, name, &ParamSpec::name)))
          all.push_back(std::move(r));
  const auto found = meanings(all);
  EXPECT_TRUE(found.at("tethers").ends_with(" (off, on)")) << found.at("tethers");
  EXPECT_TRUE(found.at("stiffness of Bullet deformable").ends_with(" [N/m]"));
  EXPECT_TRUE(found.contains("stiffness of Bullet"));
  EXPECT_FALSE(found.contains("stiffness"));
}

TEST(Terms, LeaveOutAnOrderThatStandsInTheLabelByItsOwnName) {
  std::vector<Record> all(2, synthetic::record("hang", "jakobsen", 1, 1.0 / 64));
  for (const std::size_t i : {0u, 1u}) {
    const std::string order = i == 0 ? "coloured" : "mesh";
    all[i].params["order"] = order;
    all[i].resolved_settings = {{kLinkOrder, "in some order", order}};
  }
  EXPECT_TRUE(meanings(all).contains("mesh"));
  EXPECT_FALSE(meanings(all).contains("order"));
  EXPECT_FALSE(meanings(all).contains("order of Jakobsen"));
}

TEST(PageAnswers, APenetrationNamesItsMomentAndBulletsPush) {
  Reported made;
  made.add("ball", "jakobsen", {{"penetration.peak", 0.001}});
  made.add("ball", "bullet", {{"penetration.peak", 0.01}}).params["hardness"] = "0.1";
  const Answer answer = made.answer();
  const std::string& caption = answer.table("penetration.peak").caption;
  EXPECT_NE(caption.find("at the end of a step"), std::string::npos);
  EXPECT_NE(caption.find("Bullet corrects a share of a depth, its hardness: 0.1"),
            std::string::npos)
      << caption;
}

TEST(TheStudyOfTrade, BeginsWithTheCheapestSettingOfEverySolver) {
  std::map<std::string, int> cheapest;
  for (const std::string& text : load_study("trade", "").solvers) {
    const SolverChoice choice = parse_solver(text);
    const auto one = [&](std::string_view name) {
      return name.empty() || !choice.params.has(name) || choice.params.integer(name) <= 1;
    };
    cheapest[std::string(choice.entry->name)] +=
        one(choice.entry->accuracy.substeps) && one(choice.entry->accuracy.sweeps);
  }
  cheapest.erase("bullet-deformable");  // the study does not vary its Newton iterations
  for (const auto& [solver, n] : cheapest) EXPECT_GE(n, 1) << solver;
}

TEST(TheStudyOfTrade, HasSearchedSettingsOfEverySolverOnEveryScene) {
  const Study quick = load_study("trade", "quick");
  for (const std::string& scene : quick.scenes) {
    const StudyScene own = parse_study_scene(scene);
    const Scene read = load_scene(find_scene(own.name), own.settings);
    std::set<std::string> asked, found;
    for (const std::string& text : quick.solvers) {
      const SolverChoice choice = parse_solver(text);
      const auto& unsupported = choice.entry->unsupported;
      if (!unsupported || unsupported(read, choice.params).empty())
        asked.insert(std::string(choice.entry->name));
    }
    EXPECT_GE(asked.size(), 8u);
    for (const SearchedSetting& one : read_searched(quick.searched))
      if (one.chosen() && one.scene == scene)
        found.insert(std::string(parse_solver(one.solver).entry->name));
    EXPECT_EQ(found, asked) << scene;
  }
}

TEST(PageAnswers, AtEqualSweepsHaveOnlySolversThatSweep) {
  Reported made;
  for (const char* solver : {"jakobsen", "pd", "admm", "implicit", "vbd"})
    made.add("hang", solver, {{"stretch.rms", 0.01}, {"motion.share", 1}});
  const Answer answer = made.answer();
  const auto& row = answer.table("stretch.rms").rows[0];
  for (const std::size_t sweeps : {1u, 5u}) EXPECT_EQ(row[sweeps].number(), 0.01);
  for (const std::size_t solves : {2u, 3u, 4u}) EXPECT_EQ(row[solves].text(), "does not sweep");
  EXPECT_EQ(answer.table("motion.share").rows[0][2].number(), 1) << "how it moves is said of all";
}

TEST(PageAnswers, AskOfCostsFirstAndOfEqualSweepsLast) {
  Reported made;
  made.add("hang", "jakobsen", {{"stretch.rms", 0.01}, {"motion.share", 1}});
  made.input.bench = bench_of({{"hang", "jakobsen", 1, 1, 0.01, 1e-3}});
  std::vector<std::string> names;
  for (const Table& table : made.answer().tables) names.push_back(table.name);
  EXPECT_EQ(names, (std::vector<std::string>{"price", "setting", "equal_cost", "motion.share",
                                             "stretch.rms", "failures"}));
}

TEST(PageAnswers, SayWhatADefaultSettingDoes) {
  Reported made;
  made.add("ball", "jakobsen", {{"stretch.rms", 0.01}});
  made.input.bench = bench_of({{"ball", "jakobsen", 1, 1, 0.2, 2e-3},
                               {"ball", "jakobsen", 2, 1, 0.02, 4e-3},
                               {"ball", "xpbd", 1, 1, 0.1, 2e-3}});
  EXPECT_TRUE(made.answer().table("default").rows.empty());
  made.input.bench->scenes[0].cases[1].record.spec.solver = "jakobsen";
  const Table table = made.answer().table("default");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.at(table.rows[0], "jakobsen").number(), 0.02);
  EXPECT_NE(table.at(table.rows[0], "jakobsen").note.find("256"), std::string::npos)
      << table.at(table.rows[0], "jakobsen").note;
  EXPECT_EQ(table.at(table.rows[0], "xpbd").text(), "not timed");
}

/// The map of timed cases and its cells.
struct Mapped {
  explicit Mapped(const std::vector<Timed>& timed) {
    made.add("hang", "jakobsen", {{"stretch.rms", 0.01}});
    made.input.bench = bench_of(timed);
  }
  WinnerMap map() const {
    CaseList list(made.input);
    return winners_of(made.input, list);
  }
  std::string said() const { return join(sentences_of(map()), " ", text_of); }
  Reported made;
};

TEST(Winners, AreTheCheapestBesideTiesAndWhatDoesNotCount) {
  Mapped one({{"ball", "jakobsen", 1, 1, 0.2, 2e-3},
              {"ball", "jakobsen", 2, 1, 0.02, 4e-3},
              {"ball", "xpbd", 1, 1, 0.2, 2.02e-3},
              {"ball", "bullet", 1, 1, 0.2, 5e-3},
              {"ball", "vbd", 1, 1, 0.05, 1e-3}});
  SceneBench& scene = one.made.input.bench->scenes[0];
  scene.cases[4].record.values["tunnelling.events"] = 1;
  scene.limits = {{"tunnelling.events", 0}};
  const auto cells = one.map().rows.at(0).cells;
  ASSERT_EQ(cells.size(), std::size(kErrorLevels));
  ASSERT_EQ(cells[0].cheapest.size(), 2u) << "two costs within 5 % are alike";
  EXPECT_EQ(cells[0].cheapest[0].solver, "jakobsen");
  EXPECT_EQ(cells[0].cheapest[1].solver, "xpbd");
  EXPECT_EQ(cells[0].next->solver, "bullet");
  EXPECT_NEAR(cells[0].times.mid, 2.5, 1e-9);
  EXPECT_FALSE(cells[0].won());
  EXPECT_NEAR(cells[0].bullet->times->mid, 2.5, 1e-9);
  EXPECT_FALSE(cells[2].bullet);
  EXPECT_EQ(cells[0].excluded.at(0).first, "vbd");
  ASSERT_EQ(cells[2].cheapest.size(), 1u);
  EXPECT_FALSE(cells[2].next) << "nobody else reaches 10 %";
  EXPECT_EQ(cells[5].why, "at best 2 % (jakobsen:iterations=1,substeps=2,precision=double)");
  EXPECT_TRUE(cells[5].cheapest.empty());
  EXPECT_EQ(one.said(),
            "btSoftBody costs 2.5 times the cheapest for 20\u00A0% on ball. "
            "Jakobsen is cheapest in 3 of 6 cells. 2 cells have several that noise cannot tell "
            "apart; 1 cell is reached by nobody.");
}

TEST(Winners, SayWhoWroteTheSolvers) {
  const Mapped both({{"ball", "jakobsen", 1, 1, 0.2, 4e-3},
                     {"ball", "bullet", 1, 1, 0.2, 4e-3},
                     {"ball", "xpbd", 1, 1, 0.1, 1e-3}});
  EXPECT_EQ(authors_text(both.map()),
            "taut\u2019s authors wrote Jakobsen and XPBD; Bullet is the code of others.");
  const Mapped own({{"ball", "jakobsen", 1, 1, 0.2, 4e-3}});
  EXPECT_EQ(authors_text(own.map()), "");
}

TEST(Winners, SayWhereTheSolverOfThisProjectLoses) {
  Mapped one({{"ball", "jakobsen", 1, 1, 0.2, 4e-3}, {"ball", "xpbd", 1, 1, 0.1, 1e-3}});
  Answer answer{"report", ""};
  const auto add = [&](const char* name, double own, double other) {
    answer.add(Table{name,
                     name,
                     {Column("scene"), Column("jakobsen"), Column("xpbd", "XPBD")},
                     {{"mean of 2 scenes", own, other}}});
  };
  add("penetration.peak", 2e-3, 1e-3);
  add("tunnelling.events", 1, 2);
  add("largest_step", 0.1, 0.2);
  add("slip.distance", 1e-3, 0.99e-3);  // as good as equal
  add("reference.rms", std::nan(""), 1);
  const Table lost = losses_of(one.map(), answer);
  std::vector<std::string> rows;
  for (const auto& row : lost.rows)
    rows.push_back(join(row, "; ", [](const Cell& cell) { return cell.text(); }));
  EXPECT_EQ(rows,
            (std::vector<std::string>{"CPU time of 50\u00A0%; ball; 4.0 times as dear; XPBD 1 × 1",
                                      "CPU time of 20\u00A0%; ball; 4.0 times as dear; XPBD 1 × 1",
                                      "CPU time of 10\u00A0%; ball; does not reach it; XPBD 1 × 1",
                                      "penetration.peak; mean of 2 scenes; 0.002; XPBD 0.001",
                                      "largest_step; mean of 2 scenes; 0.1; XPBD 0.2"}));
}

TEST(Winners, HaveTheirRangeInASentence) {
  Mapped one({{"hang", "jakobsen", 1, 1, 0.0005, 1e-3},
              {"hang", "pd", 1, 1, 0.05, 3e-3},
              {"hang", "pd", 2, 1, 0.002, 9e-3}});
  for (auto& c : one.made.input.bench->scenes[0].cases)
    if (c.record.solver == "pd") {
      const bool soft = c.record.substeps == 2;
      c.record.params["structural"] = soft ? "1000" : "1e+05";
      c.record.resolved_settings = {
          {kLinksSetting, "Hooke springs: as structural says", "", soft ? 1000.0 : 1e5}};
    }
  EXPECT_EQ(one.said(), "Jakobsen is cheapest in 6 of 6 cells, by 3.0 to 9.0 times.");
  const WinnerRow row = one.map().rows.at(0);
  EXPECT_EQ(row.cells[0].next->links, "1e+05 N/m");
  EXPECT_EQ(row.cells[0].next->setting.text(), "1 × 1") << "its stiffness is said once, beside it";
  EXPECT_EQ(row.cells[4].next->links, "1000 N/m");
  EXPECT_EQ(row.cells[4].next->setting.text(), "2 × 1");
  EXPECT_EQ(row.cells[0].cheapest[0].links, "");
  EXPECT_EQ(row.by, JudgedBy::motion);
  EXPECT_EQ(line_of(row, 5),
            "hang at 1\u00A0%: Jakobsen 1 × 1, double: 1.1\u00A0ms a frame; 9.0 (9.0 to 9.0) times "
            "cheaper than Projective Dynamics");
}

/// Cases of a study over stiffness.
struct Stiffened {
  Record& add(const std::string& stiffness, const std::string& solver, double share, double strain,
              double energy) {
    Record r = synthetic::record("swing", solver, 16, 1.0 / 64);
    if (!stiffness.empty())
      r.spec.settings.push_back("links.stiffness={ structural = " + stiffness + " }");
    r.values = {{"motion.share", share},
                {"motion.error", 1 - share},
                {"stretch.rms", strain},
                {"energy.peak", energy}};
    return records.emplace_back(r);
  }
  std::vector<Record> records;
};

TEST(FailureMap, SaysTheFirstThatHoldsAndTheNumbersBehindIt) {
  Stiffened made;
  const double none = std::nan("");
  made.add("1e3", "jakobsen", 0.49, 0.004, 1);
  made.add("1e6", "jakobsen", 0.51, 0.004, 1);
  made.add("1e3", "xpbd", 0.91, 0.004, 0.03);
  made.add("1e6", "xpbd", 0.1, 0.006, 0.01);
  made.add("1e3", "bullet", none, 0.004, 0.01);
  made.add("1e6", "bullet", 1, 0.5, 1).status = {Status::Kind::extreme, Reason::stretch, 3, 1};
  made.add("1e6", "pd", 1, 0, 0).status = {Status::Kind::unsupported, "no balls", -1, -1};
  const Table table = failure_map(made.records, {}, nullptr);
  ASSERT_EQ(table.columns.size(), 3u);
  EXPECT_EQ(table.columns[1].heading, "swing, structural = 1e3");
  EXPECT_EQ(table.columns[2].heading, "swing, structural = 1e6");
  ASSERT_EQ(table.rows.size(), 4u);
  EXPECT_EQ(table.rows[0][1].text(), "freezes");
  EXPECT_EQ(table.rows[0][2].text(), "is elsewhere");
  EXPECT_EQ(table.rows[1][1].text(), "gains energy");
  EXPECT_EQ(table.rows[1][2].text(), "strains");
  EXPECT_EQ(table.rows[2][1].text(), "not judged");
  EXPECT_EQ(table.rows[2][2].text(), "extreme");
  EXPECT_EQ(table.rows[3][2].text(), "cannot: no balls");
  EXPECT_EQ(table.rows[3][2].state, Cell::State::refused);
  EXPECT_TRUE(table.rows[3][1].empty()) << "was not run";
  EXPECT_EQ(table.rows[0][1].note, "51\u00A0% from its motion, strain 0.40\u00A0%, energy 1 m g L");
  EXPECT_EQ(table.rows[2][1].note, "strain 0.40\u00A0%, energy 0.010 m g L")
      << "its motion is not known";
}

TEST(FailureMap, IsOfCasesThatDifferInStiffnessAlone) {
  Stiffened made;
  made.add("", "jakobsen", 1, 0, 0);
  EXPECT_TRUE(failure_map(made.records, {}, nullptr).rows.empty());
  made.add("1e3", "jakobsen", 1, 0, 0);
  EXPECT_TRUE(failure_map(made.records, {}, nullptr).rows.empty()) << "one stiffness";
  made.add("1e4", "jakobsen", 1, 0, 0);
  EXPECT_EQ(failure_map(made.records, {}, nullptr).columns.size(), 3u);
}

TEST(FailureMap, GroupsByNumbersAndParametersAndNotByWords) {
  Stiffened made;
  made.add("1e3", "jakobsen", 0.1, 0, 0);
  made.add("1e6", "jakobsen", 1, 0, 0);
  Record& other = made.add("", "xpbd", 1, 0, 0);
  other.spec.settings.emplace_back("links.stiffness={structural=1000}");
  const Table table = failure_map(made.records, {}, nullptr);
  ASSERT_EQ(table.columns.size(), 3u) << "1e3 and 1000 are one stiffness";
  EXPECT_EQ(table.columns[1].heading, "swing, structural = 1e3");
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[1][1].text(), "right");
  EXPECT_TRUE(table.rows[1][2].empty());
}

TEST(FailureMap, LosesNoCase) {
  Stiffened made;
  for (const char* stiffness : {"1e3", "1e6"}) {
    made.add(stiffness, "jakobsen", 0.1, 0, 0);
    made.add(stiffness, "jakobsen", 1, 0, 0).params["precision"] = "float";
    made.add(stiffness, "jakobsen", 1, 0.5, 0).key += "of another version";
    Record& finer = made.add(stiffness, "jakobsen", 0.8, 0, 0);
    finer.spec.settings.emplace_back("cloth.grid=[64, 64]");
    made.add(stiffness, "jakobsen", 1, 0, 1).dt /= 2;
  }
  made.records.push_back(made.records.front());  // the same case twice
  const Table table = failure_map(made.records, {}, nullptr);
  std::vector<std::string> headings;
  for (const Column& column : table.columns) headings.push_back(column.heading);
  EXPECT_EQ(headings, (std::vector<std::string>{
                          "solver", "swing, dt = 0.015625 s, structural = 1e3",
                          "swing (cloth.grid=[64, 64]), dt = 0.015625 s, structural = 1e3",
                          "swing, dt = 0.0078125 s, structural = 1e3",
                          "swing, dt = 0.015625 s, structural = 1e6",
                          "swing (cloth.grid=[64, 64]), dt = 0.015625 s, structural = 1e6",
                          "swing, dt = 0.0078125 s, structural = 1e6"}));
  std::vector<std::string> first_half, second_half;
  for (const auto& row : table.rows)
    for (std::size_t i = 1; i < row.size(); ++i)
      (i < 4 ? first_half : second_half).push_back(row[i].text());
  EXPECT_EQ(first_half, (std::vector<std::string>{"freezes", "is elsewhere", "gains energy",
                                                  "right", "", "", "strains", "", ""}));
  EXPECT_EQ(second_half, first_half);
}

}  // namespace
}  // namespace taut::report::questions_test
