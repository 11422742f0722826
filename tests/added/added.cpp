// Adding takes one file: a program with one more metric and one more solver, each in a file that is
// named nowhere else, shows both in the page's model like its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/io/scene_io.hpp"
#include "experiments/case/case.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/report/report.hpp"
#include "experiments/report/stored.hpp"
#include "experiments/require/require.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"
#include "experiments/system/json.hpp"
#include "tests/support/numbers.hpp"

namespace taut::report {
namespace {

CaseRun run(const std::string& solver, const std::string& dt) {
  return run_case(make_case({"hang",
                             {"cloth.grid=[7, 7]", "time.duration=1.5", "time.dt=\"" + dt + "\""},
                             parse_solver(solver).canonical()}),
                  {.series_rows = 20});
}

/// Model of a page with both solvers at the same work on a small sheet. Costs are made up: a sweep
/// of the new solver costs three times as much, and half of that with its accelerator.
Json model() {
  StudyResult study{"sweeps", "?", {}, 0, {{"hang", -1}}};
  StudyBench bench{"sweeps", "a machine", {{"hang", {0.99, 1, 1.01}, {}}}};
  bench.scenes[0].limits.emplace();
  ReportInput input;
  for (const std::string sweeps : {"1", "4", "16", "64"})
    for (const std::string dt : {"1/240", "1/64", "1/32"})
      for (const std::string& solver :
           {"jakobsen:substeps=1,order=mesh,iterations=" + sweeps, "made-up:passes=" + sweeps,
            "made-up:boost=on,passes=" + sweeps}) {
        const CaseRun done = run(solver, dt);
        const Record& r = done.record;
        const bool boost = solver.find("boost") != std::string::npos;
        if (!boost) study.records.push_back(r);
        if (dt != "1/64") continue;
        const std::vector<double> samples(10, 1e-4 * number_at(sweeps) *
                                                  (r.solver == "jakobsen" ? 1
                                                   : boost                ? 1.5
                                                                          : 3));
        bench.scenes[0].cases.push_back({r, {samples, samples, 4096, "", ""}});
        if (sweeps == "4" && !boost)
          for (TimeSeries& series :
               shown_series(done.series, {"hang", r.solver, r.solver, "", {}, {}, r.key}))
            input.series.push_back(std::move(series));
      }
  input.studies = {study};
  input.bench = bench;
  return parse_json(make_model(input));
}
const Json& made() {
  static const Json all = model();
  return all;
}

const Json& by_id(const char* part, const std::string& id) {
  for (const Json& one : made()[part])
    if (one["id"] == id) return one;
  throw std::runtime_error("no " + id + " among the " + part);
}

TEST(Added, AMetricIsShownInItsUnitWithItsWindow) {
  const Json& metric = made()["metrics"]["sag.rms"];
  EXPECT_EQ(metric["title"], "RMS sag");
  EXPECT_EQ(metric["unit"], "cm");
  EXPECT_EQ(metric["scale"], 100);
  EXPECT_EQ(metric["window"], "last second");
  for (const Json& one : made()["cases"]) EXPECT_GT(one["values"]["sag.rms"], 0);
}

TEST(Added, AMetricsRoleDrawsItsCharts) {
  for (const auto& [id, metric, x] : {std::tuple("hang-sag.rms", "sag.rms", "iterations"),
                                      {"hang-sag.peak", "sag.peak", "iterations"},
                                      {"hang-sag.peak-dt", "sag.peak", "dt"},
                                      {"hang-over-time-sag.rms", "sag.rms", "t"}}) {
    const Json& chart = by_id("charts", id);
    EXPECT_EQ(chart["y"]["metric"], metric);
    EXPECT_EQ(chart["y"]["unit"], "cm");
    EXPECT_EQ(chart["x"]["metric"], x);
    std::set<std::string> solvers;
    for (const Json& series : chart["series"]) solvers.insert(series["solver"]);
    EXPECT_EQ(solvers, (std::set<std::string>{"jakobsen", "made-up"}));
  }
}

TEST(Added, AMetricsRoleMakesItsQuestion) {
  const Json& table = made()["answer"]["tables"]["sag.rms"];
  EXPECT_EQ(table["title"], "RMS sag at equal sweeps");
  EXPECT_TRUE(
      table["caption"].get<std::string>().starts_with("last second; 1 × 16 (substeps × sweeps)"));
  EXPECT_EQ(table["columns"][2]["heading"], "Made up");
  EXPECT_EQ(table["columns"][2]["shown"], "cm");
  EXPECT_GT(table["rows"][0][2].get<double>(), 0);
  EXPECT_TRUE(find_value("sag.rms").second->kept);
}

TEST(Added, AValueThatIsKeptIsAnAnswer) {
  const Case one = make_case({"hang", {"cloth.grid=[3, 3]", "time.duration=0.5"}, "made-up"});
  const std::vector<std::string> kept = default_answers({one, run_case(one).record, {}});
  EXPECT_EQ(std::ranges::count(kept, "sag.rms"), 1);
  EXPECT_EQ(std::ranges::count(kept, "sag.peak"), 0);
}

/// x coordinates of a solver's points in a chart.
std::set<double> points_of(const std::string& chart, const std::string& solver) {
  std::set<double> all;
  for (const Json& series : by_id("charts", chart)["series"])
    if (series["solver"] == solver)
      for (const Json& p : series["points"]) all.insert(p["x"].get<double>());
  return all;
}

TEST(Added, ASolversOwnParametersAreItsSweepsAndSubsteps) {
  const Json& solver = by_id("solvers", "made-up");
  EXPECT_EQ(solver["title"], "Made up");
  EXPECT_EQ(solver["settings"], "boost=off") << "sweeps and substeps are no choice";
  EXPECT_EQ(points_of("hang-stretch.rms", "made-up"), points_of("hang-stretch.rms", "jakobsen"));
  EXPECT_EQ(points_of("hang-stretch.rms", "made-up"), (std::set<double>{1, 4, 16, 64}));
  for (const Json& series : by_id("charts", "hang-stretch.rms")["series"])
    EXPECT_TRUE(series["join"]) << "a curve along its sweeps, not a point for each";
  EXPECT_EQ(by_id("charts", "hang-stretch.rms")["series"].size(), 2U)
      << "two solvers at one of three time steps";
  for (const Json& one : made()["cases"]) {
    if (one["solver"] != "made-up") continue;
    const std::string passes = one["parameters"]["passes"];
    EXPECT_EQ(one["brief"],
              "1 × " + passes + (one["parameters"]["boost"] == "on" ? ", boost=on" : ""));
  }
  const Json& map = by_id("maps", "hang-sweeps-made-up");
  EXPECT_EQ(map["y"]["values"], (Json{1, 4, 16, 64}));
  const auto named = [](const Json& fact) { return fact["name"] == "sweeps per substep"; };
  const Json& facts = by_id("scenes", "hang")["facts"];
  EXPECT_EQ((*std::ranges::find_if(facts, named))["value"], "1 to 64 (4 values)");
  EXPECT_FALSE(made()["method"]["studies"][0].contains("unequal"));
}

TEST(Added, ASolverIsComparedAtEqualErrorWithAllThatItHas) {
  std::map<std::string, std::string> boost;
  for (const Json& one : made()["cases"])
    boost[one["key"]] = one["parameters"].value("boost", "off");
  for (const char* name : {"price", "equal_cost"})
    for (const Json& cell : made()["answer"]["tables"][name]["notes"])
      if (cell["column"] == "made-up" && cell.contains("key")) {
        EXPECT_EQ(boost.at(cell["key"]), "on") << name;
      }
  const Json& price = made()["answer"]["tables"]["price"];
  EXPECT_NEAR(price["rows"][0][2][1].get<double>() / price["rows"][0][1][1].get<double>(), 1.5,
              0.01);
  const auto best = std::ranges::find_if(
      price["notes"], [](const Json& cell) { return cell.value("best", false); });
  ASSERT_NE(best, price["notes"].end());
  EXPECT_EQ((*best)["column"], "jakobsen");
}

TEST(Added, WhatTakesLongestIsKnownBeforehand) {
  const auto work = [](const std::string& solver) {
    return estimated_work(make_case({"hang", {}, solver}));
  };
  EXPECT_GT(work("made-up:passes=16"), 3 * work("made-up:passes=1"));
  EXPECT_EQ(work("made-up:passes=16"), work("made-up:slices=16,passes=1"));
}

TEST(Added, ItsSubstepsAreThoseOfFrontiers) {
  std::size_t found = 0;
  for (const FrontierSetting& one : frontier_settings("made-up:slices=4")) {
    if (one.name == "sweeps") {
      ++found;
      const Params params = parse_solver(one.question.base.solver).params;
      EXPECT_EQ(params.integer("slices"), 1) << "they matter in whole steps";
    }
    if (one.name == "wind") {
      ++found;
      EXPECT_NEAR(one.theory->value, 2 * 0.2 * 240 * 4, 1e-9) << "of the substep";
    }
  }
  EXPECT_EQ(found, 2U);
}

}  // namespace
}  // namespace taut::report
