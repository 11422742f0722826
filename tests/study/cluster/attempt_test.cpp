// Who goes on of two starts of one shard: judged by what each says while the other looks.
#include <gtest/gtest.h>

#include <cstdlib>

#include "core/io/text_file.hpp"
#include "core/model/input_error.hpp"
#include "experiments/study/cluster/cluster.hpp"
#include "experiments/system/clock.hpp"
#include "tests/study/cluster/speaking.hpp"

namespace taut::cluster::attempt_test {
namespace {

namespace fs = std::filesystem;

class Starts : public testing::Test {
 protected:
  Starts() { setenv("TAUT_CLUSTER_PATIENCE", "1", 1); }
  ~Starts() override { unsetenv("TAUT_CLUSTER_PATIENCE"); }

  fs::path start(const std::string& name) const { return make_start(scratch_.path(), name); }
  const fs::path& scratch() const { return scratch_.path(); }
  /// Whether the start `mine` goes on beside one that speaks.
  bool goes_on(const std::string& mine, const std::string& other, const std::string& state) const {
    const Speaking speaking(start(other), beat_line(state));
    try {
      Attempt attempt(scratch_.path(), mine);
      attempt.end("all cases");
      return true;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("is being run on zeus"), std::string::npos);
      return false;
    }
  }

 private:
  const Scratch scratch_;
};

TEST_F(Starts, OfTwoTogetherTheLesserNameGoesOnAndTheOtherGivesWay) {
  EXPECT_TRUE(goes_on("1-a", "1-b", "claiming")) << "if both gave way, nobody would run the shard";
  EXPECT_FALSE(goes_on("2-b", "2-a", "claiming")) << "if both went on, each case would run twice";
}

TEST_F(Starts, WhoRunsAlreadyGoesOnWhateverItsName) {
  EXPECT_FALSE(goes_on("1-a", "1-b", "running"));
}

// A beat every two seconds, one at the start and one at each change; a line that is being written
// does not count, and one that is none is named.
TEST_F(Starts, SayWhatTheyDo) {
  const fs::path mine = start("1");
  CampaignProgress campaign;
  campaign.cases = 7, campaign.reused = 2, campaign.ran = 3, campaign.work = 10,
  campaign.work_done = 4;
  const auto lines = [&] {
    const std::string text = read_text(mine);
    return std::ranges::count(text, '\n');
  };
  {
    Attempt attempt(scratch(), std::string("1"));
    EXPECT_EQ(lines(), 2) << "claiming, then running";
    for (int i = 0; i < 9; ++i) attempt.progress(campaign);
    EXPECT_EQ(lines(), 2) << "not every call is a beat";
    const auto running = not_ended(scratch());
    ASSERT_EQ(running.size(), 1u);
    EXPECT_EQ(running[0].last.host, host_name());
    EXPECT_LE(running[0].last.started, utc_stamp());
    EXPECT_EQ(running[0].last.state, Beat::State::running);
    EXPECT_EQ(running[0].count, 2u);
    attempt.end("all cases");
  }
  EXPECT_EQ(lines(), 3) << "and none more when it goes";
  EXPECT_TRUE(not_ended(scratch()).empty());
  const std::string last = read_text(mine);
  EXPECT_NE(
      last.find(R"({"state":"ended","done":5,"cases":7,"work":10.0,"work_done":4.0,"seconds":)"),
      std::string::npos)
      << last;
  EXPECT_NE(last.find(R"("why":"all cases","host":")" + host_name() + "\""), std::string::npos)
      << last;
  { const Attempt left(scratch(), std::string("2")); }
  EXPECT_NE(read_text(start("2")).find(R"("why":"an error")"), std::string::npos);
  const fs::path cut = start("3");
  write_file(cut, beat_line("running") + "\n" + beat_line("ended"));
  ASSERT_EQ(not_ended(scratch()).size(), 1u);
  EXPECT_EQ(not_ended(scratch())[0].count, 1u);
  write_file(cut, beat_line("running") + "\n" + beat_line("dancing") + "\n");
  try {
    not_ended(scratch());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), cut.string() + ":2: state: unknown state 'dancing'");
  }
}

// Who was silent for the whole of another's patience is written off, and nobody waits again.
TEST_F(Starts, WhoIsSilentIsLost) {
  const fs::path silent = start("0");
  append(silent, beat_line("running") + "\n");
  const auto begun = SteadyClock::now();
  { Attempt attempt(scratch(), std::string("1")); }
  EXPECT_GE(seconds_since(begun), 0.99) << "patience is a second here";
  EXPECT_TRUE(not_ended(scratch()).empty());
  EXPECT_TRUE(read_text(silent).ends_with(
      R"("seconds":0.0,"why":"lost","host":"zeus","started":"20260102T030405Z"})"
      "\n"));
  setenv("TAUT_CLUSTER_PATIENCE", "-3", 1);
  EXPECT_EQ(patience().count(), 8);
  setenv("TAUT_CLUSTER_PATIENCE", "2.5", 1);
  EXPECT_EQ(patience().count(), 2.5);
}

}  // namespace
}  // namespace taut::cluster::attempt_test
