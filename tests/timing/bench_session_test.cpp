// Numbers of a bench session: valid timings, comparisons, the progress of a search, and what is
// stored.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/system/files.hpp"
#include "experiments/timing/recommendation.hpp"
#include "experiments/timing/study_bench.hpp"
#include "tests/support/damaged_results.hpp"

namespace taut::bench_session_test {
namespace {

BenchedCase timed(const std::string& solver, std::vector<double> samples, double dt = 0.5) {
  BenchedCase c;
  c.record.key = std::string(64, 'a');
  c.record.solver = solver;
  c.record.spec = {"sheet", {}, solver};
  c.record.scene = "sheet";
  c.record.dt = dt;
  c.timing.samples = samples;
  c.timing.wall = samples;
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

TEST(BenchedCases, AreCandidatesByErrorOrFailure) {
  SceneBench bench{"sheet", {1, 1, 1}, {timed("a", {1, 3}), timed("b", {1, 1}), timed("c", {})}};
  bench.limits.emplace();
  bench.cases[0].record.values["e"] = -0.25;
  bench.cases[1].record.status = {Status::Kind::exploded, Reason::energy, 12, 3};
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

TEST(BenchedCases, BeyondTheLimitsOfTheirSceneWinNothing) {
  SceneBench bench{"ball", {1, 1, 1}, {timed("a", {1, 1}), timed("b", {1, 1})}};
  bench.cases[0].record.values["tunnelling.events"] = 2;
  bench.cases[1].record.values["tunnelling.events"] = 0;
  bench.limits = {{"tunnelling.events", 0}};
  const auto judged = bench.candidates("e");
  EXPECT_EQ(judged[0].refusal, Candidate::Refusal::not_accepted);
  EXPECT_EQ(judged[0].failure, "tunnelling.events 2, more than 0");
  EXPECT_FALSE(judged[1].is_uncounted());
  EXPECT_EQ(judged[1].failure, "");
  bench.limits.reset();
  for (const Candidate& one : bench.candidates("e"))
    EXPECT_EQ(one.failure, "the limits of its scene are unknown");
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

TEST(BenchedCases, ASearchEndedIfEveryParameterDid) {
  SceneBench bench{
      "sheet", {1, 1, 1}, {timed("xpbd", {1, 1}), timed("xpbd", {1, 1}), timed("bullet", {1, 1})}};
  const auto set = [&](std::size_t at, const char* substeps, const char* sweeps) {
    bench.cases[at].record.params = {{"substeps", substeps}, {"iterations", sweeps}};
  };
  set(0, "1024", "1");
  set(1, "1", "127");
  set(2, "1024", "128");
  EXPECT_FALSE(bench.searched_to_the_end("xpbd"));
  EXPECT_TRUE(bench.searched_to_the_end("bullet"));
  set(1, "1", "128");
  EXPECT_TRUE(bench.searched_to_the_end("xpbd")) << "each by some case";
  set(0, "1023", "1");
  EXPECT_FALSE(bench.searched_to_the_end("xpbd"));
  EXPECT_FALSE(bench.searched_to_the_end("nobody"));
  EXPECT_FALSE(bench.searched_to_the_end("jakobsen")) << "none was timed";
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

/// Results folder that contains these records.
class Kept {
 public:
  explicit Kept(const StudyBench& session) {
    for (const SceneBench& scene : session.scenes)
      for (const BenchedCase& c : scene.cases) store.commit(c.record);
    keep(store, session);
  }
  const Scratch scratch;
  std::string said;
  Store store{scratch.path() / "results", [this](const std::string& text) { said += text; }};
};

BenchedCase stored_case(const std::string& solver, std::vector<double> samples, char key) {
  BenchedCase c = timed(solver, std::move(samples));
  c.record.key = std::string(64, key);
  return c;
}

TEST(StoredBenches, AreWhatWasKept) {
  StudyBench session{"trade",
                     "m",
                     {{"sheet", {0.5, std::nan(""), 2}, {stored_case("a", {1, 2}, 'a')}},
                      {"ball", {1, 1, 1}, {stored_case("b", {2, 4}, 'b')}, false}},
                     "zeus",
                     "b"};
  session.scenes[0].cases[0].timing.remark = "it says otherwise";
  session.scenes[1].cases.push_back(stored_case("c", {}, 'c'));
  session.scenes[1].cases[1].timing.failure = "no clock";
  Kept kept(session);
  const auto all = stored_benches(kept.store, "trade");
  ASSERT_EQ(all.size(), 1u);
  const StudyBench& back = all[0];
  EXPECT_EQ(back.study + back.machine + back.host + back.build, "trademzeusb");
  ASSERT_EQ(back.scenes.size(), 2u);
  EXPECT_EQ(back.scenes[0].scene, "sheet");
  EXPECT_EQ(back.scenes[0].control.low, 0.5);
  EXPECT_TRUE(std::isnan(back.scenes[0].control.mid));
  const Timing& timing = back.scenes[0].cases[0].timing;
  EXPECT_EQ(timing.samples, (std::vector<double>{1, 2}));
  EXPECT_EQ(timing.wall, (std::vector<double>{3, 6}));
  EXPECT_EQ(timing.peak_bytes, 4096u);
  EXPECT_EQ(timing.remark, "it says otherwise");
  EXPECT_EQ(back.scenes[0].cases[0].record.solver, "a");
  EXPECT_FALSE(back.scenes[1].in_turns);
  ASSERT_EQ(back.scenes[1].cases.size(), 2u);
  EXPECT_FALSE(back.scenes[1].ratio(0, 0)) << "not timed in turns";
  EXPECT_TRUE(back.scenes[0].ratio(0, 0));
  EXPECT_EQ(back.scenes[1].cases[1].timing.failure, "no clock");
  EXPECT_TRUE(stored_benches(kept.store, "other").empty());
  forget(kept.store, std::string(64, 'a'));
  EXPECT_EQ(stored_benches(kept.store, "trade")[0].scenes.size(), 1u)
      << "a case that is no longer stored";
}

TEST(StoredBenches, TakeThePlaceOfThoseOfTheirHostAndBuildAlone) {
  StudyBench session{
      "trade", "m", {{"sheet", {1, 1, 1}, {stored_case("a", {1, 2}, 'a')}}}, "zeus", "b"};
  Kept kept(session);
  session.scenes[0].cases[0].timing.samples = {5, 5};
  keep(kept.store, session);
  session.host = "ares";
  keep(kept.store, session);
  StudyBench here = StudyBench::here("trade");
  EXPECT_EQ(here.machine, machine_name());
  EXPECT_EQ(here.host, host_name());
  EXPECT_EQ(here.build.size(), 64u);
  here.scenes = session.scenes;
  here.build = "old";
  keep(kept.store, here);
  here.build = StudyBench::here("").build;
  keep(kept.store, here);
  std::string order;
  for (const StudyBench& one : stored_benches(kept.store, "trade")) {
    EXPECT_EQ(one.scenes[0].cases[0].timing.samples[0], 5) << "the last that was kept";
    order += one.host == here.host ? one.build.substr(0, 3) + ' ' : one.host + ' ';
  }
  EXPECT_EQ(order, here.build.substr(0, 3) + " old ares zeus ") << "this host and build first";
}

TEST(StoredBenches, ThatDoNotMatchTheirDigestCountAsNone) {
  for (const char* damage :
       {"UPDATE samples SET cpu = 3 WHERE sample = 1", "UPDATE samples SET wall = 'x'",
        "DELETE FROM samples WHERE sample = 1", "UPDATE timings SET peak_bytes = 1",
        "UPDATE timings SET failure = 'no clock'", "UPDATE timings SET remark = 'x'",
        "DELETE FROM timings", "UPDATE benches SET control = 2", "UPDATE benches SET host = 'ares'",
        "UPDATE benches SET in_turns = 0", "UPDATE benches SET scene = 'ball'"}) {
    Kept kept({"trade", "m", {{"sheet", {1, 1, 1}, {stored_case("a", {1, 2}, 'a')}}}, "zeus", "b"});
    EXPECT_EQ(stored_benches(kept.store, "trade").size(), 1u);
    EXPECT_EQ(kept.said, "");
    change(kept.store, damage);
    EXPECT_TRUE(stored_benches(kept.store, "trade").empty()) << damage;
    EXPECT_NE(kept.said.find("damaged bench of "), std::string::npos) << damage << kept.said;
  }
}

TEST(Costs, AreMediansForWhoeverAsks) {
  Kept kept({"trade",
             "m",
             {{"sheet",
               {1, 1, 1},
               {stored_case("a", {4, 1, 2, 8}, 'a'), stored_case("b", {5, 1, 2}, 'b'),
                stored_case("c", {}, 'c')}}},
             "zeus",
             "b"});
  Database file(kept.store.file(), Database::Access::read);
  file.script("PRAGMA trusted_schema = ON");  // as every client opens the file
  Database::Rows row = file.rows(
      "SELECT solver, cpu, cpu_per_second, wall, samples, memory, host FROM costs ORDER BY solver");
  std::string all;
  while (row.next())
    all += row.text(0) + " " + number_text(row.number(1)) + " " + number_text(row.number(2)) + " " +
           number_text(row.number(3)) + " " + row.text(4) + " " + row.text(5) + " " + row.text(6) +
           "\n";
  EXPECT_EQ(all, "a 3 6 9 4 4096 zeus\nb 2 4 6 3 4096 zeus\nc - - - 0 4096 zeus\n");
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
