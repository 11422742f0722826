// Taking times: where samples begin, the order and number of the steps that workers are asked for,
// and the use of their answers.
#include "experiments/timing/timing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>
#include <thread>

#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/timing/interleave.hpp"
#include "tests/support/scripted.hpp"

namespace taut::timing_test {
namespace {

/// Solver whose state is the number of its steps, and whose clock advances half a second per step.
class Counting final : public Solver {
 public:
  void load(const State& state) override {
    steps_ = state.x[0].x();
    log << "load " << steps_ << "; ";
  }
  void step(double t, double dt) override {
    log << std::lround(t / dt) << " ";
    steps_ += 1;
    ++all_;
  }
  void store(State& state) const override { state = {{Vec3(steps_, 0, 0)}, {Vec3::Zero()}}; }
  std::vector<PassCost> step_cost() const override { return {}; }
  double cpu_seconds() const override { return 0.5 * all_; }
  std::ostringstream log;

 private:
  double steps_ = 0;
  int all_ = 0;
};

/// Requests to a solver for samples of `sample_steps` in a run of `run_steps`.
std::string asked(int run_steps, int sample_steps) {
  Scene scene;
  scene.dt = 0.25;
  scene.start = {{Vec3::Zero()}, {Vec3::Zero()}};
  Counting solver;
  const CheckpointedRun run(scene, solver, run_steps);
  EXPECT_EQ(run.whole().cpu, run_steps > 0 ? 0.5 : 0);
  EXPECT_GE(run.whole().wall, 0);
  EXPECT_LT(run.whole().wall, 1);
  solver.log.str("");
  EXPECT_EQ(run.sample(solver, sample_steps).cpu, 0.5) << "the step that warms up is not in it";
  return solver.log.str();
}

TEST(CheckpointedRuns, SamplesBeginEvenlySpacedAndAreWarmedUpByAStep) {
  EXPECT_EQ(asked(20, 7), "load 0; 0 load 0; 0 1 2 load 10; 10 load 10; 10 11 12 ")
      << "three from each of two starts";
  EXPECT_EQ(asked(20, 1), "load 0; 0 load 0; 0 load 10; 10 load 10; 10 ");
  EXPECT_EQ(asked(16, 100),
            "load 0; 0 load 0; 0 1 2 3 4 5 6 7 load 8; 8 load 8; 8 9 10 11 12 13 14 15 ")
      << "none runs into the next";
  EXPECT_EQ(asked(15, 2), "load 0; 0 load 0; 0 1 ") << "eight steps apart at least";
  EXPECT_EQ(
      asked(33, 4),
      "load 0; 0 load 0; 0 load 8; 8 load 8; 8 load 16; 16 load 16; 16 load 24; 24 load 24; 24 ")
      << "four starts at most";
  EXPECT_EQ(asked(3, 9), "load 0; 0 load 0; 0 1 2 ");
}

TEST(TimedSteps, AsManyAsFit) {
  EXPECT_EQ(times_within(1, 0.25, 100), 4);
  EXPECT_EQ(times_within(1, 0.26, 100), 3);
  EXPECT_EQ(times_within(1, 7, 100), 1);
  EXPECT_EQ(times_within(1, 0.001, 100), 100);
  EXPECT_EQ(times_within(1, 0, 12345), 12345);
  Record record;
  record.steps = 90;
  EXPECT_EQ(steps_done(record), 90);
  record.status.step = 12;
  EXPECT_EQ(steps_done(record), 12);
  record.status.step = 0;
  EXPECT_EQ(steps_done(record), 90);
}

TEST(TimedSteps, TheMachineIsNamedByItsProcessorAndItsCores) {
  std::ifstream info("/proc/cpuinfo");
  const std::string all{std::istreambuf_iterator<char>(info), {}};
  std::smatch model;
  if (!std::regex_search(all, model, std::regex("model name\\s*: (.*)")))
    GTEST_SKIP() << "no model name";
  EXPECT_EQ(machine_name(),
            model[1].str() + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores");
}

const CaseSpec kSpec{"hang", {"cloth.grid=[4, 4]", "time.duration=0.5"}, "scripted:iterations=2"};

/// Answers like a timing worker. The k-th sample of worker w takes 0.00wk s of CPU and 0.1wk s in
/// all, a pilot run 0.002 s.
const std::string kWorker = R"(w=$(ls $folder | wc -l); : >$folder/w.$w
echo "$*" >>$folder/w.$w
echo ready 2
k=0
while read word n; do
  echo "$w $word $n" >>$folder/.log
  case $word in
    pilot_run) echo 0.002 0.004;;
    time) k=$((k + 1)); echo 0.00$w$k 0.1$w$k;;
    memory) echo 40$w;;
    remark) echo remark $w;;
  esac
done
)";

std::string failure(const std::function<void()>& what) {
  try {
    what();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(TimingWorkers, AreAskedLineByLine) {
  const Scripted scripted(kWorker);
  TimingWorker worker(kSpec);
  const StepTime pilot = worker.pilot_run(31), sample = worker.sample(5);
  EXPECT_EQ(pilot.cpu, 0.002);
  EXPECT_EQ(pilot.wall, 0.004);
  EXPECT_EQ(sample.cpu, 0.0001);
  EXPECT_EQ(sample.wall, 0.101);
  EXPECT_EQ(worker.peak_bytes(), 400u);
  EXPECT_EQ(worker.remark(), "remark 0");
  EXPECT_EQ(scripted.told(".log"), "0 pilot_run 31\n0 time 5\n0 memory \n0 remark \n");
  EXPECT_EQ(scripted.told("w.0"),
            "bench --worker hang scripted:iterations=2 --set cloth.grid=[4, 4] --set "
            "time.duration=0.5\n");
}

TEST(TimingWorkers, WhatTheyRefuseAndThatTheyDieIsSaid) {
  Scripted scripted("echo ready 2; read a; echo '! it has no clock'; read a; exit 1");
  TimingWorker worker(kSpec);
  EXPECT_EQ(failure([&] { worker.pilot_run(3); }), "it has no clock");
  EXPECT_EQ(failure([&] { worker.sample(3); }), "the timing worker died");
  const std::string who = "the timing worker of hang scripted:iterations=2 ";
  scripted.write("exit 0");
  EXPECT_EQ(failure([] { TimingWorker{kSpec}; }), who + "did not start");
  for (const char* script : {"echo ready; sleep 1000", "echo ready 1; sleep 1000"}) {
    scripted.write(script);
    EXPECT_EQ(failure([] { TimingWorker{kSpec}; }),
              who + "is of a build that cannot be timed beside this one");
  }
  scripted.write("echo ready 2; read a; echo 4096; sleep 1000");
  TimingWorker odd(kSpec);
  EXPECT_EQ(failure([&] { odd.pilot_run(3); }), "the timing worker answered '4096'");
  scripted.write("echo ready 2; exec sleep 1000");
  TimingWorker silent(kSpec);
  const auto start = SteadyClock::now();
  silent.give_up_at(in_seconds(0.15));
  EXPECT_THROW(silent.pilot_run(3), TimeIsUp);
  EXPECT_GE(seconds_since(start), 0.149);
  EXPECT_LT(seconds_since(start), 5);
}

TEST(Rounds, GoForthAndBackAndSayHowFarTheyAre) {
  std::string log;
  interleave(
      3,
      {.count = 2,
       .progress =
           [&](std::size_t done, std::size_t all) {
             log += std::to_string(done) + "/" + std::to_string(all) + " ";
           }},
      [&](std::size_t i) { log += std::string(1, static_cast<char>('A' + i)); },
      [&] { log += "-"; });
  EXPECT_EQ(log, "ABC-CBA1/2 ABC-CBA2/2 ");
  int samples = 0;
  interleave(1, {.count = 2, .deadline = SteadyClock::now()}, [&](std::size_t) { ++samples; });
  EXPECT_EQ(samples, 0) << "the deadline has passed";
}

TEST(Benches, GoForthAndBackAndTheFirstCaseIsItsOwnControl) {
  const Scripted scripted(kWorker);
  CaseSpec other = kSpec;
  other.solver = "scripted:iterations=9";
  std::vector<std::pair<std::size_t, std::size_t>> told;
  const TimingSession bench =
      time_cases({{kSpec, 100}, {other, 7}},
                 {.rounds = 2, .seconds = 0.05, .progress = [&](std::size_t k, std::size_t n) {
                    told.emplace_back(k, n);
                  }});
  std::string expected = "0 pilot_run 100\n1 pilot_run 7\n2 pilot_run 100\n";
  for (int round = 0; round < 2; ++round)
    expected += "0 time 25\n1 time 7\n2 time 25\n2 time 25\n1 time 7\n0 time 25\n";
  for (const char* w : {"0", "1"}) expected += w + std::string(" memory \n") + w + " remark \n";
  std::string log = scripted.told(".log");
  const std::string first_run = "0 pilot_run 100\n", second_run = "1 pilot_run 7\n";
  if (const std::string swapped = second_run + first_run; log.starts_with(swapped))
    log.replace(0, swapped.size(), first_run + second_run);  // pilot runs start concurrently
  EXPECT_EQ(log, expected);
  EXPECT_EQ(told, (std::vector<std::pair<std::size_t, std::size_t>>{{1, 2}, {2, 2}}));
  ASSERT_EQ(bench.timings.size(), 2u);
  const Timing &first = bench.timings[0], &second = bench.timings[1];
  EXPECT_EQ(first.samples, (std::vector<double>{0.0001, 0.0002, 0.0003, 0.0004}));
  EXPECT_EQ(second.samples, (std::vector<double>{0.0011, 0.0012, 0.0013, 0.0014}));
  EXPECT_EQ(second.wall, (std::vector<double>{0.111, 0.112, 0.113, 0.114}));
  EXPECT_EQ(second.peak_bytes, 401u);
  EXPECT_EQ(second.remark, "remark 1");
  EXPECT_EQ(first.failure, "");
  const Interval control =
      interleaved_ratio(first.samples, std::vector{0.0021, 0.0022, 0.0023, 0.0024});
  EXPECT_EQ((std::tuple{bench.control.low, bench.control.mid, bench.control.high}),
            (std::tuple{control.low, control.mid, control.high}));
  EXPECT_EQ(bench.ratio(1, 0).mid, interleaved_ratio(second.samples, first.samples).mid);
  EXPECT_TRUE(time_cases({}, {}).timings.empty());
}

TEST(Benches, AFailureCostsItsOwnCaseAlone) {
  const Scripted scripted(
      "case $4 in *iterations=2*) echo ready 2; read a; echo '! no clock'; cat >/dev/null;; *) "
      ":; " +
      kWorker + " esac");
  CaseSpec other = kSpec;
  other.solver = "scripted:iterations=9";
  const TimingSession bench =
      time_cases({{other, 50}, {kSpec, 100}, {other, 0}}, {.rounds = 3, .seconds = 0.01});
  EXPECT_EQ(bench.timings[0].samples.size(), 6u);
  EXPECT_EQ(bench.timings[1].failure, "no clock");
  EXPECT_TRUE(bench.timings[1].samples.empty());
  EXPECT_EQ(bench.timings[2].samples.size(), 6u);
  EXPECT_NE(scripted.told(".log").find("pilot_run 1\n"), std::string::npos) << "one step at least";
  const TimingSession late =
      time_cases({{other, 50}}, {.rounds = 3, .deadline = SteadyClock::now()});
  EXPECT_EQ(late.timings[0].failure, "time is up");
  EXPECT_TRUE(late.timings[0].samples.empty());
}

TEST(Benches, TheOrderOfCasesDecidesNothing) {
  CaseSpec other = kSpec, third = kSpec;
  other.solver = "scripted:iterations=9";
  third.solver = "scripted:iterations=7";
  // iterations=2 is refused at the start, iterations=7 from its third sample on.
  const Scripted scripted(
      "case $4 in *iterations=2*) echo ready 2; read a; echo '! no clock'; cat "
      ">/dev/null;; *iterations=7*) echo ready 2; n=0; while read a b; do n=$((n + "
      "1)); if [ $n -gt 3 ]; then echo '! broke'; else echo 0.003 0.004; fi; "
      "done;; *) :; " +
      kWorker + " esac");
  const CaseToTime refused{kSpec, 100}, good{other, 50}, breaks{third, 50};
  for (const std::vector<CaseToTime>& cases : {std::vector{refused, good},
                                               {good, refused},
                                               {breaks, good},
                                               {refused, breaks, good},
                                               {good, breaks}}) {
    const TimingSession bench = time_cases(cases, {.rounds = 6, .seconds = 0.01});
    EXPECT_TRUE(std::isfinite(bench.control.mid));
    EXPECT_GT(bench.control.mid, 0);
  }
  EXPECT_TRUE(std::isnan(time_cases({refused}, {.rounds = 2}).control.mid)) << "nothing to compare";
}

// Four samples of 0.2 s make a round of 0.8 s. After the first round at most 1.1 s are left: enough
// for a round of the same length, but not for one that is half as long again. The start of the
// worker may take 0.7 s of the rest, as it does under sanitizers.
TEST(Benches, NoRoundBeginsThatMayNotEnd) {
  const Scripted scripted(
      "echo ready 2; while read word n; do [ $word = time ] && sleep 0.2; echo 1 1; done\n");
  const auto rounds = [](double seconds) {
    const auto bench =
        time_cases({{kSpec, 9}}, {.rounds = 3, .deadline = in_seconds(seconds)}).timings[0];
    EXPECT_EQ(bench.failure, "");
    EXPECT_EQ(bench.wall.size(), bench.samples.size());
    return bench.samples.size() / 2;
  };
  EXPECT_EQ(rounds(1.9), 1u);
  EXPECT_EQ(rounds(60), 3u);
}

// The test program itself is the worker (tests/support/main.cpp).
TEST(Benches, TimeTheStepsOfASolver) {
  const CaseSpec real{"hang", {"cloth.grid=[8, 8]", "time.duration=0.5"}, "jakobsen"};
  EXPECT_EQ(program_of(real), this_program());
  TimingWorker worker(real);
  const StepTime pilot = worker.pilot_run(32), sample = worker.sample(16);
  EXPECT_GT(pilot.cpu, 1e-7);
  EXPECT_LT(pilot.cpu, 0.1);
  EXPECT_GT(sample.cpu, 1e-7);
  EXPECT_GT(sample.wall, 1e-7);
  EXPECT_GT(worker.peak_bytes(), std::size_t{1} << 20);
  EXPECT_NE(failure([&] { TimingWorker({"nowhere", {}, "jakobsen"}); }), "");
}

}  // namespace
}  // namespace taut::timing_test
