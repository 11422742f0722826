// The page and its model: one file that contains everything, and nothing that the data do not
// support.
#include "experiments/report/report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "core/model/input_error.hpp"
#include "experiments/report/chart/wording.hpp"
#include "experiments/report/input.hpp"
#include "experiments/report/questions/case_list.hpp"
#include "experiments/report/questions/compared_solvers.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"
#include "tests/report/made_up.hpp"
#include "tests/support/synthetic_records.hpp"

namespace taut::report::report_test {
namespace {

namespace fs = std::filesystem;

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

/// Report of a bare run: two studies on two scenes, with strain over time.
ReportInput example() {
  ReportInput input;
  input.command = "./taut run iterations time-steps";
  input.provenance = {{"program", "0123456789"}, {"toolchain", "g++ 12.2.0"}};
  input.solvers = {{"jakobsen", "Verlet with relaxed distance constraints", "Jakobsen 2001"},
                   {"bullet", "btSoftBody", "Bullet 3.24"}};
  input.scenes = {{"hang", "A sheet held by two corners"}, {"ball", "A sheet on a ball"}};
  StudyResult sweeps{"iterations", "How fast does stretch fall?", {}, 40, {{"hang", -1}}};
  StudyResult steps{"time-steps", "Which steps survive?", {}, 0, {}};
  for (const std::string scene : {"hang", "ball"}) {
    for (const Record& r : synthetic::iterations(scene)) sweeps.records.push_back(r);
    for (const Record& r : synthetic::time_steps(scene)) steps.records.push_back(r);
  }
  for (StudyResult* study : {&sweeps, &steps})
    for (Record& r : study->records) {
      const auto depth = r.values.extract("penetration.max");
      if (r.scene == "ball" && depth) r.values["penetration.peak"] = depth.mapped();
    }
  input.studies = {sweeps, steps};
  for (const std::string solver : {"jakobsen", "bullet"}) {
    TimeSeries series{"ball", solver, solver_title(solver), "stretch.rms", {}, {}};
    for (int i = 0; i <= 160; ++i) {
      const double t = i / 64.0;
      series.t.push_back(t);
      series.y.push_back((solver == "bullet" ? 0.06 : 0.02) * std::exp(-t) * (1 - std::cos(6 * t)));
    }
    input.series.push_back(series);
  }
  return input;
}

Json model_of(const ReportInput& input) { return parse_json(make_model(input)); }

TEST(Report, TablesAndChartsAreOfValuesWithARole) {
  std::size_t dropped = 0;
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    ReportInput whole = made_up::Maker(seed).input(), roles = whole;
    for (ReportInput* input : {&whole, &roles})
      for (StudyResult& study : input->studies)
        for (Record& r : study.records) {
          r.values["energy.peak"] = 1;
          r.values["stretch.p95"] = 0.01;
          if (input != &roles) continue;
          const std::size_t before = r.values.size();
          keep_roles(r);
          dropped += before - r.values.size();
        }
    Json model = model_of(whole), of_roles = model_of(roles);
    for (const char* read_alone : {"cases", "metrics"}) {
      model.erase(read_alone);
      of_roles.erase(read_alone);
    }
    EXPECT_EQ(model, of_roles) << "seed " << seed;
  }
  EXPECT_GT(dropped, 0u);
}

TEST(Report, OneFileThatAsksForNothing) {
  const std::string html = make_report(example());
  EXPECT_TRUE(html.starts_with("<!doctype html>"));
  for (const PageFile& file : page_files())
    EXPECT_EQ(html.find("{{" + std::string(file.name) + "}}"), std::string::npos);
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  const auto open = html.find("id=\"model\">") + 11;
  EXPECT_EQ(parse_json(html.substr(open, html.find("</script>", open) - open)),
            model_of(example()));
}

TEST(Report, NamesFromOutsideStayText) {
  ReportInput input = example();
  const std::size_t scripts = count(make_report(input), "</script");
  const std::string evil = "</script><img src=x onerror=alert(1)><!--{{page.js}}";
  input.title = evil;
  input.command = evil;
  input.scenes[0].summary = evil;
  for (Record& r : input.studies[0].records) {
    r.status.reason = evil;
    r.params["x"] = evil;
  }
  const std::string html = make_report(input);
  EXPECT_EQ(count(html, "</script"), scripts);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_EQ(html.find("<!--"), std::string::npos);
}

TEST(Model, TitleCountsTheSolversOfStudiesAndOfTimedCases) {
  ReportInput input = example();
  input.bench = StudyBench{"trade", "a machine", {{"hang", {1, 1, 1}, {}}}};
  for (const char* solver : {"pd", "vbd"}) {
    BenchedCase& one = input.bench->scenes[0].cases.emplace_back();
    one.record = input.studies[0].records[0];
    one.record.solver = solver;
    one.record.key = solver;
  }
  const std::string title = model_of(input)["meta"]["title"].get<std::string>();
  EXPECT_TRUE(title.starts_with("4 cloth solvers on ")) << title;
}

TEST(Model, HasEveryPartThatTheDataHaveAndNoOther) {
  const Json model = model_of(example());
  EXPECT_EQ(model["schema"], "taut-report/8");
  for (const char* part : {"meta", "solvers", "statuses", "metrics", "answer", "scenes", "charts",
                           "maps", "tables", "method", "missing", "cases"})
    EXPECT_TRUE(model.contains(part) && !model[part].empty()) << part;
  for (const char* part : {"cost", "limits", "truths", "regressions", "films", "left_out"})
    EXPECT_FALSE(model.contains(part)) << part;
  EXPECT_EQ(model["missing"].size(), 4U);
  EXPECT_EQ(model["meta"]["title"], "Jakobsen and Bullet");
  EXPECT_EQ(model["scenes"][0]["maps"].size(), 2U);
}

/// Map of a study over stiffness, with the cost of a step where it was measured.
TEST(Model, HasTheFailureMap) {
  ReportInput input{.studies = {{"one", "?", {}, 0, {}}}};
  for (const char* stiffness : {"1e3", "1e6"}) {
    Record r = synthetic::record("swing", "jakobsen", 4, 1.0 / 64);
    r.spec.settings = {std::string("links.stiffness={ structural = ") + stiffness + " }"};
    r.key += stiffness;
    r.values = {{"motion.share", 0.1}, {"motion.error", 0.9}, {"stretch.rms", 0.001}};
    input.studies[0].records.push_back(r);
  }
  input.bench = StudyBench{"one", "a machine", {}};
  BenchedCase timed{.record = input.studies[0].records[1], .timing = {}};
  timed.timing.samples = {0.002};
  timed.timing.wall = {0.002};
  input.bench->scenes.push_back({.scene = "swing", .control = {1, 1, 1}, .cases = {timed}});
  const Json model = model_of(input);
  EXPECT_EQ(model["limits"]["tables"], Json{"failure_map"});
  const Json& table = model["tables"]["failure_map"];
  EXPECT_EQ(table["rows"][0][1], "freezes");
  EXPECT_EQ(table["rows"][0][2], "freezes");
  int with_cost = 0;
  for (const Json& note : table["notes"])
    with_cost += note.value("note", "").ends_with(" a simulated second");
  EXPECT_EQ(with_cost, 1);
}

/// Every id that is referred to exists exactly once; every quantity has an entry in the glossary.
void check_references(const Json& model) {
  std::map<std::string, int> ids;
  for (const char* part : {"charts", "maps", "films", "scenes"})
    for (const Json& one : model.value(part, Json::array())) ++ids[one["id"]];
  for (const auto& [id, n] : ids) EXPECT_EQ(n, 1) << id;
  for (const auto& [name, table] : model["tables"].items()) ++ids[name];
  std::map<std::string, int> cases;
  for (const Json& one : model["cases"]) ++cases[one["key"]];
  for (const auto& [key, n] : cases) EXPECT_EQ(n, 1) << key;
  const auto named = [&](const Json& owner, const char* list) {
    for (const Json& id : owner.value(list, Json::array()))
      EXPECT_TRUE(ids.contains(id.get<std::string>())) << id;
  };
  for (const Json& scene : model["scenes"])
    for (const char* list : {"charts", "maps", "tables"}) named(scene, list);
  if (model.contains("cost")) named(model["cost"], "tables");
  const auto known_case = [&](const Json& key) {
    EXPECT_TRUE(cases.contains(key.get<std::string>())) << key;
  };
  for (const Json& tables : {model["answer"]["tables"], model["tables"]})
    for (const Json& table : tables)
      for (const Json& cell : table["notes"])
        if (cell.contains("key")) known_case(cell["key"]);
  for (const Json& chart : model.value("charts", Json::array())) {
    for (const char* axis : {"x", "y"})
      EXPECT_TRUE(model["metrics"].contains(chart[axis]["metric"].get<std::string>()));
    for (const Json& series : chart["series"])
      for (const Json& p : series.value("points", Json::array())) known_case(p["case"]);
  }
  for (const Json& map : model.value("maps", Json::array()))
    for (const Json& cell : map["cells"]) known_case(cell["case"]);
}

TEST(Model, EveryReferenceLeadsSomewhere) {
  check_references(model_of(example()));
  ReportInput several = example();  // three settings of a solver, each with a map
  for (const char* omega : {"1.3", "1.6"})
    for (Record r : synthetic::time_steps("hang")) {
      r.params["omega"] = omega;
      r.id += omega;
      r.key += omega;
      several.studies[1].records.push_back(r);
    }
  check_references(model_of(several));
  EXPECT_EQ(model_of(several)["scenes"][0]["maps"].size(), 6U);
  for (unsigned seed = 0; seed < 20; ++seed)
    check_references(model_of(made_up::Maker(seed).input()));
}

TEST(Model, SurvivesNanFailuresOnlyAndASingleSolver) {
  ReportInput input = example();
  for (StudyResult& study : input.studies)
    for (Record& r : study.records) r.values["stretch.rms"] = std::nan("");
  check_references(model_of(input));
  for (StudyResult& study : input.studies)
    for (Record& r : study.records) synthetic::fail(r, Status::Kind::timeout, "60 s");
  check_references(model_of(input));
  input = example();
  for (StudyResult& study : input.studies)
    std::erase_if(study.records, [](const Record& r) { return r.solver == "bullet"; });
  check_references(model_of(input));
}

TEST(Model, WithoutAnyRecordIsAnInputError) {
  EXPECT_THROW(make_model({}), InputError);
  ReportInput input;
  input.studies = {{"iterations", "?", {}, 12, {}}};
  EXPECT_THROW(make_report(input), InputError);
}

TEST(Model, WhatIsMissingNamesTheCommandThatMakesIt) {
  ReportInput input = example();
  const auto commands = [&] {
    std::map<std::string, std::string> all;
    const Json model = model_of(input);
    for (const Json& one : model.value("missing", Json::array()))
      all[one["section"]] = one["command"].get<std::string>();
    return all;
  };
  EXPECT_EQ(commands(),
            (std::map<std::string, std::string>{{"cost", "taut bench trade --preset quick"},
                                                {"films", "taut render hang --video"},
                                                {"truths", "taut verify --record"},
                                                {"regressions", "taut check --record"}}));
  input.studies.pop_back();
  EXPECT_EQ(commands()["cost"], "taut bench iterations");
  input.truths.emplace();
  input.regressions.emplace();
  input.media = {{.scene = "hang"}};
  EXPECT_EQ(commands().size(), 1u);
  input.bench = StudyBench{"trade", "a machine", {}};
  EXPECT_EQ(commands().size(), 0u);
}

TEST(Model, FiguresOfTheWholeAreCounted) {
  ReportInput input = example();
  std::set<std::string> keys;  // the studies share some keys
  for (const StudyResult& study : input.studies)
    for (const Record& r : study.records) keys.insert(r.key);
  const std::size_t cases = keys.size();
  const Json meta = model_of(input)["meta"];
  EXPECT_EQ(meta["cases"], cases);
  EXPECT_EQ(meta["planned"], cases + 40 - input.studies[0].records.size());
  EXPECT_FALSE(meta.contains("listed"));
  EXPECT_EQ(meta["build"], (Json{{"program", "0123456789"}, {"toolchain", "g++ 12.2.0"}}));
  input.truths = Truths{{{"truths", 2}, {"findings", 3}}};
  input.regressions = {{"cases", 7}, {"values", 90}};
  const Json model = model_of(input);
  EXPECT_EQ(model["truths"], input.truths->shown);
  EXPECT_EQ(model["regressions"], *input.regressions);
}

/// Limits of the results, from the last paragraph of the method.
std::string limits(const ReportInput& input) {
  std::string all;
  const Json model = model_of(input);
  for (const Json& point : model["method"]["limits"]) all += point.get<std::string>() + "\n";
  return all;
}

TEST(Model, WhatResultsSayNothingOfIsAllThatWasNotRun) {
  ReportInput input = example();
  std::string said = limits(input);
  EXPECT_NE(said.find("Other scenes than hang and ball, simulated for 4.00\u00A0s"), said.npos)
      << said;
  EXPECT_NE(
      said.find("Other time steps than 1.00\u00A0ms to 100\u00A0ms, other work than 1 substeps "
                "of 1 to 256 sweeps"),
      said.npos)
      << said;
  EXPECT_NE(said.find("no CPU time was measured"), said.npos);
  EXPECT_NE(said.find("The " + std::to_string(40 - input.studies[0].records.size()) +
                      " planned cases that have not been run."),
            said.npos)
      << said;
  input.studies = {{"one", "?", {synthetic::record("box", "jakobsen", 4, 1.0 / 64)}, 1, {}}};
  input.bench = StudyBench{"one", "a machine", {}};
  said = limits(input);
  EXPECT_NE(said.find("Other scenes than box, "), said.npos) << said;
  EXPECT_NE(said.find("time steps than 15.6\u00A0ms, other work than 1 substeps of 4 sweeps;"),
            said.npos)
      << said;
  EXPECT_NE(said.find("Cost on another machine than a machine"), said.npos) << said;
  EXPECT_EQ(said.find("planned"), said.npos) << said;
}

// If a page cannot carry all cases, it has those that something on it refers to, and others evenly.
TEST(CasesOfAPage, AreThoseNamedAndOthersWhileThereIsRoom) {
  ReportInput input{.studies = {{"many", "?", {}, 0, {}}}};
  std::vector<Record>& records = input.studies[0].records;
  for (std::size_t i = 0; i < 3 * kMostCases; ++i) {
    records.push_back({});
    records.back().key = std::string(i % 2 ? "a" : "b") + std::to_string(100'000 + i);
  }
  const auto listed = [&](std::size_t cases, std::size_t named) {
    ReportInput part{.studies = {{"many", "?", {}, 0, {}}}};
    part.studies[0].records.assign(records.begin(),
                                   records.begin() + static_cast<std::ptrdiff_t>(cases));
    CaseList list(part);
    std::set<std::string> keys, expected;
    for (std::size_t i = 0; i < named; ++i) {
      list.key(records[cases - 1 - i].key);
      expected.insert(records[cases - 1 - i].key);
    }
    std::vector<std::size_t> places;  // places of other cases
    for (const Record* r : list.listed())
      if (keys.insert(r->key).second && !expected.contains(r->key))
        places.push_back(static_cast<std::size_t>(r - part.studies[0].records.data()));
    for (const std::string& key : expected) EXPECT_TRUE(keys.contains(key)) << key;
    for (std::size_t k = 1; k < places.size(); ++k) {  // even spacing in the study's order
      const double way = static_cast<double>(cases - named - 1) /
                         static_cast<double>(std::max<std::size_t>(1, places.size() - 1));
      EXPECT_NEAR(static_cast<double>(places[k] - places[k - 1]), way, 1) << k;
    }
    return keys.size();
  };
  EXPECT_EQ(listed(kMostCases, 0), kMostCases);
  EXPECT_EQ(listed(kMostCases, 100), kMostCases);
  EXPECT_EQ(listed(3 * kMostCases, 0), kMostCases);
  EXPECT_EQ(listed(3 * kMostCases, 1500), kMostCases);
  EXPECT_EQ(listed(3 * kMostCases, kMostCases + 7), kMostCases + 7);
}

TEST(Model, SolversStandInTheOrderOfTheStudy) {
  ReportInput input = example();
  for (StudyResult& study : input.studies) std::ranges::reverse(study.records);
  const Json solvers = model_of(input)["solvers"];
  EXPECT_EQ(solvers[0]["id"], "bullet");
  EXPECT_EQ(solvers[0]["colour"], model_of(example())["solvers"][1]["colour"]);
}

TEST(Model, AFilmShowsTheScenesOwnQuantityFirst) {
  ReportInput input = example();
  input.media = {{.scene = "ball"}};
  input.media[0].footage.type = "image/png";
  input.media[0].footage.bytes = "x";
  input.media[0].footage.duration = 2.5;
  for (const auto& [value, y] : {std::pair{"penetration.max", 1e-10}, {"slip.distance", 0.1}})
    input.series.push_back({"ball", "bullet", "Bullet", value, {0, 1, 2}, {0, y, y}});
  const Json model = model_of(input);
  std::vector<std::string> shown;
  for (const Json& track : model["films"][0]["tracks"]) shown.push_back(track["metric"]);
  EXPECT_EQ(shown, (std::vector<std::string>{"slip.distance", "stretch.rms"}));
}

TEST(Model, PicturesThatWouldBurstThePageAreLeftOut) {
  ReportInput input = example();
  Footage footage;
  footage.type = "video/mp4";
  footage.bytes = std::string(4'000'000, 'x');
  input.media = {{.scene = "ball", .footage = footage}, {.scene = "hang", .footage = footage}};
  const Json films = model_of(input)["films"];
  ASSERT_EQ(films.size(), 2U);
  EXPECT_TRUE(films[0].contains("src"));
  EXPECT_FALSE(films[1].contains("src"));
  EXPECT_TRUE(films[1].contains("left_out"));
}

TEST(Model, ScenesOutsideStudiesHaveWhoRefusesThem) {
  ReportInput input = example();
  SceneMedia more{.scene = "twist", .summary = "A strip, wound up"};
  more.refused = {{"bullet", "self-collision is not what it does"}};
  input.media.push_back(more);
  const Json scenes = model_of(input)["scenes"];
  EXPECT_EQ(scenes.back()["id"], "twist");
  EXPECT_FALSE(scenes.back()["studied"]);
  EXPECT_EQ(scenes.back()["refusals"][0]["solver"], "bullet");
}

TEST(ComparedSolvers, OnlyTheSameQuestionIsQuotedSideBySide) {
  ReportInput input = example();
  for (Record& r : input.studies[0].records)
    if (r.solver == "bullet") r.spec.settings = {"cloth.grid=[8, 8]"};
  input.studies.pop_back();
  const ComparedSolvers compared = compared_solvers_of(input);
  for (const QuotedScene& quoted : compared.scenes)
    EXPECT_EQ(std::ranges::count(quoted.cases, nullptr), 1) << "another grid is another question";
  for (const ComparedSolver& solver : compared.all) EXPECT_EQ(solver.work.sweeps, 16);
  EXPECT_EQ(compared.common_work(), "1 × 16 (substeps × sweeps)");
}

TEST(Files, WhatCannotBeWrittenIsSaidBeforeAnythingIsDone) {
  EXPECT_THROW(test_writable(fs::temp_directory_path()), InputError);
  EXPECT_THROW(test_writable("/proc/no-such/report.html"), InputError);
  const fs::path file = fs::temp_directory_path() / "taut_writable" / "report.html";
  test_writable(file);
  EXPECT_TRUE(fs::is_empty(file.parent_path()));
  fs::remove_all(file.parent_path());
}

}  // namespace
}  // namespace taut::report::report_test
