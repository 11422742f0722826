// A case in a process of its own: its arguments, its limits, and the status for each way to end.
#include "experiments/study/isolate.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <regex>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/results/store.hpp"
#include "experiments/system/clock.hpp"
#include "tests/support/scripted.hpp"

namespace taut::isolate_test {
namespace {

namespace fs = std::filesystem;
using Kind = Status::Kind;

const CaseSpec kSmall{
    "hang", {"cloth.grid=[4, 3]", "time.duration=0.28125"}, "scripted:iterations=2"};  // 18 steps

class Isolated : public testing::Test {
 protected:
  Record record_of(const std::string& script, const Limits& limits = {}) {
    scripted_.write(script);
    make_folder(folder_);
    return IsolatedCase(one_, folder_, limits).wait();
  }
  Scripted scripted_{""};
  const Scratch scratch_;
  const fs::path folder_ = scratch_.path() / "case";
  const Case one_ = make_case(kSmall);
};

TEST_F(Isolated, IsToldAllOfTheCaseAndBound) {
  scripted_.write(
      "for word; do echo \"$word\"; done >$folder/words; cat /proc/self/limits >$folder/limits\n");
  const auto words = [&](int frames) {
    make_folder(folder_);
    IsolatedCase(one_, folder_, {.seconds = 3, .bytes = 400 << 20}, frames).wait();
    return scripted_.told("words");
  };
  const std::string common = "case\nhang\n" + one_.spec.solver + "\n--into\n" + folder_.string() +
                             "\n--set\ncloth.grid=[4, 3]\n--set\ntime.duration=0.28125\n";
  const auto limit = [&](const std::string& name) {
    std::smatch found;
    const std::string all = scripted_.told("limits");
    EXPECT_TRUE(std::regex_search(all, found, std::regex(name + " +(\\d+)"))) << all;
    return std::stoul(found[1]);
  };
  EXPECT_EQ(words(0), common);
  EXPECT_EQ(limit("Max cpu time"), 3u);
#ifndef TAUT_SANITIZED  // the sanitizer's shadow memory alone takes terabytes
  EXPECT_EQ(limit("Max data size"), 400u << 20);
#endif
  EXPECT_EQ(limit("Max file size"), 256u << 20);
  EXPECT_EQ(words(5), common + "--frames\n5\n");
  EXPECT_EQ(limit("Max file size"), (256u << 20) + 19 * (8 + 3 * 4 * 12))
      << "and its motion: of 12 vertices in float, at all steps";
}

TEST_F(Isolated, EveryEndHasItsStatus) {
  struct End {
    const char *script, *reason;
    Kind kind;
    int step = -1;
  };
  const End ends[] = {
      {"exit 3", "exit code 3", Kind::error},
      {"echo no; echo why >&2; exit 1", "why", Kind::error},
      {"printf '\\007\\0\\0\\0' >$5/heartbeat; exit 4", "exit code 4", Kind::error, 7},
      {"printf '\\007\\0\\0\\0' >$5/heartbeat; exit 74", "exit code 74", Kind::error, 7},
      {"kill -SEGV $$", "SIGSEGV", Kind::crash},
      {"echo why >&2; kill -ABRT $$", "SIGABRT: why", Kind::crash},
      {"kill -XCPU $$", "CPU time", Kind::timeout},
      {"exit 77", "more than the limit of 300 MB (taut run --memory raises it)", Kind::oom}};
  for (const End& end : ends) {
    const Record record = record_of(end.script, {.bytes = (300 << 20) + 9});
    EXPECT_EQ(record.status.kind, end.kind) << end.script;
    EXPECT_EQ(record.status.reason.text(), end.reason);
    EXPECT_EQ(record.status.step, end.step) << end.script;
    EXPECT_EQ(record.status.vertex, -1);
    EXPECT_EQ(record.key, one_.key);
    EXPECT_EQ(record.id, one_.id);
    fs::remove_all(folder_);
  }
}

// Limits of time are the solver's. `at_work` is a metric, 1/16 s has been spent on metrics.
TEST_F(Isolated, TheTimeOfMetricsIsNotTheSolvers) {
  const auto with_metric = [](const std::string& at_work, const std::string& script) {
    return "printf '\\007\\0\\0\\0" + at_work +
           "\\0\\0\\0\\0\\0\\0\\0\\0\\0\\260\\077' >$5/heartbeat; " + script;
  };
  const std::string name(metrics()[1]->name);
  for (const char* script : {"kill -XCPU $$", "sleep 9"}) {
    const Record record = record_of(with_metric("\\002", script), {.seconds = 0.05});
    EXPECT_EQ(record.status.kind, Kind::error);
    EXPECT_EQ(record.status.reason.text(),
              "the metric '" + name + "' takes longer than the solver may");
    EXPECT_EQ(record.status.step, 7);
    fs::remove_all(folder_);
  }
  EXPECT_EQ(record_of(with_metric("\\0", "kill -XCPU $$"), {}).status.kind, Kind::timeout);
  fs::remove_all(folder_);
  EXPECT_EQ(
      record_of(with_metric("\\0", "sleep 0.4; exit 3"), {.seconds = 0.05}).status.reason.text(),
      "exit code 3")
      << "a quarter of a second is the solver's alone";
}

// A case that was ended from outside has no record and runs again the next time.
TEST_F(Isolated, WhatIsEndedFromOutsideHasNoRecord) {
  for (const char* script : {"kill -KILL $$", "kill -TERM $$", "kill -INT $$", "kill -HUP $$",
                             "exit 130", "echo why >&2; exit 78"}) {
    EXPECT_THROW(record_of(script, {.bytes = 300 << 20}), EndedFromOutside) << script;
    fs::remove_all(folder_);
  }
  EXPECT_THROW(record_of("kill -STOP $$; sleep 9", {.seconds = 0.05}), EndedFromOutside);
  fs::remove_all(folder_);
  EXPECT_EQ(record_of("sleep 9", {.seconds = 0.05}).status.reason.text(), "wall time");
}

// A process starts as a copy of its parent, and the system counts the parent's memory in its peak.
TEST_F(Isolated, MemoryOfWhatStartsItIsNotItsOwn) {
  const std::string held(200 << 20, 'x');
  EXPECT_THROW(record_of("kill -KILL $$", {.bytes = 300 << 20}), EndedFromOutside) << held.back();
}

TEST(ProcessEnds, OutOfMemoryIsToldFromAKill) {
  const std::size_t limit = std::size_t{1} << 30;
  EXPECT_TRUE((ProcessEnd{-1, SIGKILL, limit / 2 - 1}).from_outside(limit));
  EXPECT_FALSE((ProcessEnd{-1, SIGKILL, limit / 2}).from_outside(limit));
  EXPECT_FALSE((ProcessEnd{-1, SIGSEGV, 1}).from_outside(limit));
  EXPECT_FALSE((ProcessEnd{3, 0, 1}).from_outside(limit));
}

TEST_F(Isolated, OnlyItsOwnRecordIsTaken) {
  const Record mine =
      run_case(make_case({kSmall.scene, kSmall.settings, "jakobsen:iterations=2"})).record;
  Record its = mine;
  its.key = one_.key;
  write_file(scripted_.folder() / "its", to_json(its));
  write_file(scripted_.folder() / "other", to_json(mine));
  EXPECT_EQ(to_json(record_of("cp $folder/its $5/case.json\n")), to_json(its));
  // Another build of the program made it: that is no result of the case.
  EXPECT_THROW(record_of("cp $folder/other $5/case.json\n"), InputError);
  const Status none = record_of("rm $5/case.json\n").status,
               cut = record_of("head -c 99 $folder/its >$5/case.json\n").status;
  EXPECT_EQ(none.kind, Kind::error);
  EXPECT_EQ(cut.kind, Kind::error);
  EXPECT_NE(cut.reason.text().find("case.json"), std::string::npos);
}

TEST_F(Isolated, WhatStaysOfItIsWhatSaysSomething) {
  const auto left = [&](const std::string& script) {
    record_of("echo 1 >$5/heartbeat; echo 1 >$5/series.json\n" + script);
    std::string names;
    for (const char* name : {"case.json", "heartbeat", "series.json", "stderr.txt"})
      names += fs::exists(folder_ / name) ? std::string(name) + " " : "";
    fs::remove_all(folder_);
    return names;
  };
  Record its = run_case(make_case({kSmall.scene, kSmall.settings, "jakobsen:iterations=2"})).record;
  its.key = one_.key;
  write_file(scripted_.folder() / "its", to_json(its));
  EXPECT_EQ(left("cp $folder/its $5/case.json"), "case.json series.json ");
  EXPECT_EQ(left("cp $folder/its $5/case.json; echo why >&2"), "case.json series.json stderr.txt ");
  EXPECT_EQ(left("exit 1"), "");
}

TEST_F(Isolated, WallTimeIsFiveTimesTheCpuTimeThatItMayTake) {
  const auto start = SteadyClock::now();
  const Status status = record_of("exec sleep 1000\n", {.seconds = 0.06}).status;
  EXPECT_EQ(status.kind, Kind::timeout);
  EXPECT_EQ(status.reason.text(), "wall time");
  EXPECT_GE(seconds_since(start), 0.3);
  EXPECT_LT(seconds_since(start), 2.5);
  scripted_.write("exec sleep 1000\n");
  IsolatedCase polled(one_, folder_, {.seconds = 0.06});
  EXPECT_FALSE(polled.poll());
  std::optional<Record> record;
  while (!record) record = polled.poll();
  EXPECT_EQ(record->status.reason.text(), "wall time");
}

TEST_F(Isolated, WhatIsNoPropertyOfTheCaseIsNoRecord) {
  const auto refused = [&](const std::string& script) {
    try {
      record_of(script);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused("exit 74"), folder_.string() + ": cannot write: No space left on device");
  EXPECT_EQ(refused("printf '\\376\\377\\377\\377' >$5/heartbeat; exit 74"),
            folder_.string() + ": cannot write: No space left on device")
      << "as the case itself says in its heartbeat";
  EXPECT_EQ(refused("echo the disk is full >&2; exit 74"), "the disk is full");
  EXPECT_EQ(refused("rm -r $5; exit 3"),
            folder_.string() + ": vanished while its case was running");
}

// The test program itself runs the case (tests/support/main.cpp).
TEST(IsolatedRun, GivesWhatTheCaseGivesAndItsMotion) {
  const Scratch scratch;
  const Case one = make_case({kSmall.scene, kSmall.settings, "jakobsen:iterations=2"});
  IsolatedCase process(one, scratch.path(), {}, 4);
  const Record record = process.wait();
  EXPECT_EQ(to_json(record), to_json(run_case(one).record));
  EXPECT_GT(process.spent().metrics, 0);
  EXPECT_GT(process.spent().cpu, process.spent().metrics);
  const auto frames = frames_in(read_text(scratch.path() / kFramesFile), one.scene->mesh.size());
  std::vector<int> steps;
  for (const Frame& frame : frames)
    steps.push_back(static_cast<int>(std::lround(frame.t / one.scene->dt)));
  EXPECT_EQ(steps, (std::vector<int>{0, 4, 8, 12, 16, 18}));
  EXPECT_EQ(series_from_json(read_text(scratch.path() / kSeriesFile), "series").rows.size(), 19u);
  EXPECT_FALSE(fs::exists(scratch.path() / "heartbeat"));
}

TEST(IsolatedRun, OfALongRunItKeepsAHundredAndTwentyRows) {
  const Scratch scratch;
  const Case one = make_case({"hang", {"cloth.grid=[2, 2]", "time.duration=7.5"}, "jakobsen"});
  ASSERT_EQ(one.scene->steps, 480);
  EXPECT_EQ(run_into(one, scratch.path(), 7), 0);
  EXPECT_EQ(series_from_json(read_text(scratch.path() / kSeriesFile), "series").rows.size(), 121u);
  const auto frames = frames_in(read_text(scratch.path() / kFramesFile), one.scene->mesh.size());
  EXPECT_EQ(frames.size(), 9u) << "every 68th of 480 steps, the first and the last";
  EXPECT_EQ(Heartbeat::last(scratch.path() / "heartbeat"), 480);
}

TEST(IsolatedRun, SaysByItsExitCodeThatItCannotWrite) {
  const Scratch scratch;
  const Case one = make_case({kSmall.scene, kSmall.settings, "jakobsen:iterations=2"});
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_into(one, scratch.path() / "none"), kCannotWrite);
  EXPECT_NE(
      testing::internal::GetCapturedStderr().find("none/heartbeat: cannot write: No such file"),
      std::string::npos);
  fs::create_directories(scratch.path() / "case.json/x");
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_into(one, scratch.path()), kCannotWrite);
  EXPECT_NE(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(Heartbeat::last(scratch.path() / "heartbeat"), Heartbeat::kCannotWrite);
}

TEST(Heartbeats, AreReadWhileTheyBeat) {
  const Scratch scratch;
  const fs::path file = scratch.path() / "heartbeat";
  EXPECT_EQ(Heartbeat::last(file), Heartbeat::kCannotWrite) << "there is none";
  Heartbeat heart(file);
  EXPECT_EQ(Heartbeat::last(file), -1);
  heart.beat(123456);
  EXPECT_EQ(Heartbeat::last(file), 123456);
  heart.measures({2.5, 3});
  EXPECT_EQ(Heartbeat::last_measuring(file).seconds, 2.5);
  EXPECT_EQ(Heartbeat::last_measuring(file).metric, 3);
  EXPECT_EQ(Heartbeat::last(file), 123456);
  EXPECT_EQ(Heartbeat::last_measuring(scratch.path() / "none").metric, 0);
}

}  // namespace
}  // namespace taut::isolate_test
