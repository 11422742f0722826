// A session's numbers: what counts, what is compared, how far a search went, and what is stored of
// it.
#include <gtest/gtest.h>

#include <cmath>

#include "core/model/input_error.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/json.hpp"
#include "experiments/timing/bench/contact.hpp"
#include "experiments/timing/bench/kernels.hpp"
#include "experiments/timing/recommendation.hpp"
#include "experiments/timing/study_bench.hpp"

namespace taut::bench_session_test {
namespace {

BenchedCase timed(const std::string& solver, std::vector<double> samples, double dt = 0.5) {
  BenchedCase c;
  c.record.key = std::string(64, 'a');
  c.record.solver = solver, c.record.spec = {"sheet", {}, solver}, c.record.scene = "sheet";
  c.record.dt = dt;
  c.timing.samples = samples, c.timing.wall = samples;
  for (double& t : c.timing.wall) t *= 3;
  c.timing.peak_bytes = 4096;
  return c;
}

TEST(BenchedCases, CountIfTheyWereTimedAndCompleted) {
  BenchedCase c = timed("jakobsen", {1, 1});
  EXPECT_TRUE(c.stable());
  c.record.status.kind = Status::Kind::unsettled;
  EXPECT_TRUE(c.stable());
  for (const Status::Kind kind :
       {Status::Kind::exploded, Status::Kind::extreme, Status::Kind::timeout}) {
    c.record.status.kind = kind;
    EXPECT_FALSE(c.stable());
  }
  c.record.status.kind = Status::Kind::ok;
  c.timing.failure = "no clock";
  EXPECT_FALSE(c.stable());
  EXPECT_FALSE(timed("jakobsen", {}).stable());
  const Interval cost = timed("jakobsen", {2, 4, 6}, 0.25).cost();
  EXPECT_EQ((std::tuple{cost.low, cost.mid, cost.high}), (std::tuple{8.0, 16.0, 24.0}))
      << "per simulated second";
}

TEST(BenchedCases, AreCandidatesByTheSizeOfTheirErrorOrByWhatFailed) {
  SceneBench bench{"sheet", {1, 1, 1}, {timed("a", {1, 3}), timed("b", {1, 1}), timed("c", {})}};
  bench.cases[0].record.values["e"] = -0.25;
  bench.cases[1].record.status = {Status::Kind::exploded, "energy", 12, 3};
  bench.cases[2].timing.failure = "no clock";
  const auto all = bench.candidates("e");
  EXPECT_EQ(all[0].error, 0.25);
  EXPECT_EQ(all[0].cost.mid, 4);
  EXPECT_EQ(all[0].failure, "");
  EXPECT_EQ(all[1].failure, "exploded (energy) at step 12, vertex 3");
  EXPECT_TRUE(std::isnan(all[1].error));
  EXPECT_EQ(all[2].failure, "no clock");
  EXPECT_EQ(solvers_of(bench), (std::vector<std::string>{"a", "b", "c"}));
}

TEST(BenchedCases, AreComparedWithinASessionAlone) {
  SceneBench bench{"sheet",
                   {1, 1, 1},
                   {timed("a", {2, 2, 8, 8}, 0.5), timed("b", {1, 1, 2, 2}, 0.25),
                    timed("c", {1, 1}), timed("d", {1, 1, 1})}};
  const Interval ratio = *bench.ratio(0, 1);
  EXPECT_NEAR(ratio.low, 1, 1e-12) << "2/1 and 8/2, of steps twice as long";
  EXPECT_NEAR(ratio.high, 2, 1e-12);
  EXPECT_FALSE(bench.ratio(0, 2)) << "not as many samples";
  EXPECT_FALSE(bench.ratio(3, 3)) << "half a round";
  bench.cases[1].timing.failure = "no clock";
  EXPECT_FALSE(bench.ratio(0, 1));
  EXPECT_FALSE(bench.ratio(1, 0));
}

TEST(BenchedCases, ASearchWentToTheEndIfEveryParameterOfTheSolverDid) {
  SceneBench bench{
      "sheet", {1, 1, 1}, {timed("xpbd", {1, 1}), timed("xpbd", {1, 1}), timed("bullet", {1, 1})}};
  const auto set = [&](std::size_t at, const char* substeps, const char* sweeps) {
    bench.cases[at].record.params = {{"substeps", substeps}, {"iterations", sweeps}};
  };
  set(0, "1024", "1"), set(1, "1", "127"), set(2, "1024", "128");
  EXPECT_FALSE(bench.searched_to_the_end("xpbd"));
  EXPECT_TRUE(bench.searched_to_the_end("bullet"));
  set(1, "1", "128");
  EXPECT_TRUE(bench.searched_to_the_end("xpbd")) << "each by some case";
  set(0, "1023", "1");
  EXPECT_FALSE(bench.searched_to_the_end("xpbd"));
  EXPECT_FALSE(bench.searched_to_the_end("nobody"));
  EXPECT_FALSE(bench.searched_to_the_end("jakobsen")) << "none was timed";
  const Json file = parse_json(to_json({"trade", "m", {bench}}));
  EXPECT_EQ(to_text(file["scenes"][0]["accuracy_parameters"]["xpbd"]),
            R"({"substeps":{"largest":1023,"end":1024},"iterations":{"largest":128,"end":128}})");
}

TEST(BenchSessions, RecordsCarryCostsOfWhatWasTimed) {
  StudyBench session{"trade",
                     "m",
                     {{"sheet", {1, 1, 1}, {timed("a", {1, 2, 6}, 0.5), timed("b", {1})}},
                      {"ball", {1, 1, 1}, {timed("c", {4})}}}};
  session.scenes[0].cases[1].timing.failure = "no clock";
  const auto records = session.records();
  ASSERT_EQ(records.size(), 3u);
  EXPECT_EQ(records[0].values, (std::map<std::string, double>{{"cpu.per_step", 2},
                                                              {"cpu.per_second", 4},
                                                              {"wall.per_step", 6},
                                                              {"memory.peak", 4096}}));
  EXPECT_TRUE(records[1].values.empty());
  EXPECT_EQ(records[2].values.at("cpu.per_second"), 8);
}

TEST(BenchSessions, WhatCannotBeATimeIsRefusedWithItsPlace) {
  StudyBench session{
      "trade", "m", {{"sheet", {0.5, std::nan(""), 2}, {timed("a", {1, 2})}}}, "zeus", "b"};
  session.scenes[0].cases[0].timing.remark = "it says otherwise";
  const std::string good = to_json(session);
  const StudyBench back = bench_from_json(good, "f");
  EXPECT_EQ(to_json(back), good);
  EXPECT_EQ(
      (std::tuple{back.study, back.machine, back.host, back.build}),
      (std::tuple{std::string("trade"), std::string("m"), std::string("zeus"), std::string("b")}));
  EXPECT_EQ(back.scenes[0].control.low, 0.5);
  EXPECT_TRUE(std::isnan(back.scenes[0].control.mid));
  EXPECT_EQ(back.scenes[0].cases[0].timing.remark, "it says otherwise");
  EXPECT_EQ(back.scenes[0].cases[0].timing.wall, (std::vector<double>{3, 6}));
  const auto said = [&](const char* from, const std::string& to) -> std::string {
    Json json = parse_json(good);
    json["scenes"][0]["cases"][0][from] = parse_json(to);
    try {
      bench_from_json(to_text(json), "f");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(said("cpu_seconds_per_step", "[1, 0]"),
            "f: scenes[0].cases[0]: expected times greater than 0");
  EXPECT_EQ(said("wall_seconds_per_step", "[-1]"),
            "f: scenes[0].cases[0]: expected times greater than 0");
  EXPECT_EQ(said("cpu_seconds_per_step", "[]"),
            "f: scenes[0].cases[0]: has neither times nor a failure");
  EXPECT_EQ(said("wall_seconds_per_step", "[]"),
            "f: scenes[0].cases[0]: has neither times nor a failure");
  EXPECT_EQ(said("failure", "\"why\""), "");
  StudyBench one_by_one = session;
  one_by_one.scenes[0].in_turns = false;
  one_by_one.scenes[0].cases.push_back(timed("b", {2, 4}));
  const StudyBench again = bench_from_json(to_json(one_by_one), "f");
  EXPECT_FALSE(again.scenes[0].in_turns);
  EXPECT_FALSE(again.scenes[0].ratio(0, 1)) << "not timed in turns";
  one_by_one.scenes[0].in_turns = true;
  EXPECT_TRUE(one_by_one.scenes[0].ratio(0, 1));
  Json two = parse_json(good);
  two["scenes"][0]["control"] = Json::array({1, 2});
  EXPECT_THROW(bench_from_json(to_text(two), "f"), InputError);
}

TEST(BenchSessions, AreKeptInAFileOfTheirHostAndBuild) {
  const Scratch scratch;
  StudyBench session{"trade", "m", {}, "zeus", "0123456789abcdef"};
  const auto file = keep(scratch.path(), session);
  EXPECT_EQ(file, scratch.path() / "bench/trade/zeus-0123456789.json");
  EXPECT_EQ(read_text(file), to_json(session));
  const StudyBench here = StudyBench::here("trade");
  EXPECT_EQ(here.machine, machine_name());
  EXPECT_EQ(here.host, host_name());
  EXPECT_EQ(here.build.size(), 64u);
}

// What contact adds to a step of so many sweeps, over a sweep; what one kernel costs over another.
// Medians of the rounds.
TEST(BenchRows, RatiosAreMediansOfTheRounds) {
  ContactRow row;
  row.sweep = {2, 4, 5}, row.each_step = {1, 2, 30}, row.each_sweep = {0.5, 3, 1};
  EXPECT_EQ(row.ratio(0).mid, 0.5);
  EXPECT_EQ(row.ratio(2).mid, 2) << "1, 2 and 6.4";
  EXPECT_EQ(row.ratio(2).low, 1);
  EXPECT_EQ(row.ratio(2).high, 6.4);
  KernelBench kernels;
  kernels.rows.resize(2);
  kernels.rows[0].samples = {1, 6, 4}, kernels.rows[1].samples = {2, 3, 1};
  EXPECT_EQ(kernels.ratio(0, 1).mid, 2) << "0.5, 2 and 4";
  EXPECT_EQ(kernels.ratio(1, 0).mid, 0.5);
}

TEST(Answers, FinalistsLeaveRoomForASecondSettingOfTheBest) {
  std::vector<Candidate> tried;
  for (const auto& [solver, cost] :
       {std::pair{"a", 1.0}, {"a", 2.0}, {"b", 3.0}, {"c", 4.0}, {"d", 5.0}, {"a", 6.0}})
    tried.push_back({solver, solver + std::to_string(cost), {cost, cost, cost}, 0.01, ""});
  EXPECT_EQ(finalists(tried, {0.01, {}}, 4), (std::vector<std::size_t>{0, 2, 3, 1}));
  EXPECT_EQ(finalists(tried, {0.01, {}}, 1), (std::vector<std::size_t>{0}));
  EXPECT_EQ(finalists(tried, {0.01, {}}, 99), (std::vector<std::size_t>{0, 2, 3, 4, 1, 5}));
  EXPECT_TRUE(finalists(tried, {0.001, {}}, 4).empty());
}

TEST(Answers, WhatIsExpectedAgainStraysAsIdenticalCodeDid) {
  const SceneBench bench{"sheet", {0.8, 1, 1.1}, {timed("a", {1, 2, 4}, 0.5)}};
  const Interval again = cost_expected_again(bench, 0);
  EXPECT_NEAR(again.low, 2 / 1.25, 1e-12) << "1/0.8 is farther from 1 than 1.1";
  EXPECT_EQ(again.mid, 4);
  EXPECT_NEAR(again.high, 8 * 1.25, 1e-12);
}

TEST(Answers, ATargetReadsAsItWasAsked) {
  EXPECT_EQ(text(Target{0.01, {}}, "stretch.rms"), "stretch.rms <= 1 %");
  EXPECT_EQ(text(Target{{}, 0.24}, "stretch.rms"),
            "least stretch.rms within 4 ms a frame of 1/60 s");
}

}  // namespace
}  // namespace taut::bench_session_test
