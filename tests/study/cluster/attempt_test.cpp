// Who goes on of two starts of one shard: judged by what each says while the other looks.
#include "experiments/study/cluster/attempt.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <thread>

#include "core/model/input_error.hpp"
#include "experiments/system/files.hpp"

namespace taut::cluster::attempt_test {
namespace {

namespace fs = std::filesystem;

/// A start that speaks as long as it is there.
class Speaking {
 public:
  Speaking(const fs::path& session, const std::string& state)
      : thread_([this, session, state] {
          while (!ended_) {
            append_line(session / "beats",
                        R"({"state":")" + state +
                            R"(","done":0,"cases":9,"work":0,"work_done":0,"seconds":1,"why":""})");
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
          }
        }) {}
  ~Speaking() {
    ended_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

class Starts : public testing::Test {
 protected:
  Starts() { setenv("TAUT_CLUSTER_PATIENCE", "1", 1); }
  ~Starts() override { unsetenv("TAUT_CLUSTER_PATIENCE"); }

  fs::path session(const std::string& name) const {
    const fs::path folder = scratch_.path() / "sessions" / name;
    make_folder(folder);
    write_file(folder / "session.json", R"({"host":"zeus","started":"20260102T030405Z"})");
    return folder;
  }
  /// Whether the start `mine` goes on beside one that speaks.
  bool goes_on(const std::string& mine, const std::string& other, const std::string& state) const {
    const Speaking speaking(session(other), state);
    try {
      Attempt attempt(scratch_.path(), session(mine));
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

}  // namespace
}  // namespace taut::cluster::attempt_test
