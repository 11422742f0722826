#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>

#include "experiments/system/files.hpp"

namespace taut::cluster {

/// A line of a session's beats.
inline std::string beat_line(const std::string& state, double work = 0, double work_done = 0) {
  return R"({"state":")" + state + R"(","done":0,"cases":9,"work":)" + std::to_string(work) +
         R"(,"work_done":)" + std::to_string(work_done) + R"(,"seconds":3,"why":""})";
}

/// A start of a shard that speaks as long as it is there.
class Speaking {
 public:
  Speaking(const std::filesystem::path& session, const std::string& line)
      : thread_([this, session, line] {
          while (!ended_) {
            append_line(session / "beats", line);
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

/// A session of a shard's store, begun by the host "zeus".
inline std::filesystem::path make_session(const std::filesystem::path& shard,
                                          const std::string& name) {
  const std::filesystem::path folder = shard / "sessions" / name;
  make_folder(folder);
  write_file(folder / "session.json", R"({"host":"zeus","started":"20260102T030405Z"})");
  return folder;
}

}  // namespace taut::cluster
