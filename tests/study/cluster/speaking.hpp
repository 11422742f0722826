#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>

#include "experiments/system/files.hpp"

namespace taut::cluster {

/// A beat of a start by the host "zeus".
inline std::string beat_line(const std::string& state, double work = 0, double work_done = 0) {
  return R"({"state":")" + state + R"(","done":0,"cases":9,"work":)" + std::to_string(work) +
         R"(,"work_done":)" + std::to_string(work_done) +
         R"(,"seconds":3,"why":"","host":"zeus","started":"20260102T030405Z"})";
}

/// A start of a shard that speaks as long as it is there.
class Speaking {
 public:
  Speaking(const std::filesystem::path& file, const std::string& line) {
    append(file, line + "\n");  // before it is looked for
    thread_ = std::thread([this, file, line] {
      while (!ended_) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        append(file, line + "\n");
      }
    });
  }
  ~Speaking() {
    ended_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

/// The file of the beats of a start of a shard, of which there are none yet.
inline std::filesystem::path make_start(const std::filesystem::path& shard,
                                        const std::string& name) {
  make_folder(shard / "beats");
  return shard / "beats" / name;
}

}  // namespace taut::cluster
