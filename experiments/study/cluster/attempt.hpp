#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/study/campaign.hpp"

namespace taut::cluster {

/// A start of a shard says every two seconds that it is alive: a line in the file "beats" of its
/// session. Whoever wants to know reads twice and looks for new lines, so no clock of one host is
/// ever compared with that of another, and nothing is locked.
inline constexpr std::chrono::seconds kBeat{2};
/// Silent for so long: lost. ($TAUT_CLUSTER_PATIENCE [s] for file systems that show news late.)
std::chrono::duration<double> patience();

/// What a beat says.
struct Beat {
  enum class State { claiming, running, ended };
  State state = State::claiming;
  std::size_t done = 0, cases = 0;  ///< of the shard
  double work = 0, work_done = 0;   ///< of this start
  double seconds = 0;               ///< since it started, by its own steady clock
  std::string why;                  ///< how it ended
};

/// The beats of one session of a shard.
struct Beats {
  std::filesystem::path session;
  std::size_t count = 0;
  Beat last;
  std::string host, started;  ///< of its session.json
};

/// Those sessions of a shard's store that have not ended. Throws InputError: damaged.
std::vector<Beats> not_ended(const std::filesystem::path& shard);

/// Reads again until all of them have said more or ended, or patience is over; gives the sessions
/// that have (which live) as they are now.
std::vector<Beats> living(const std::vector<Beats>&);

/// This process's start of a shard.
class Attempt {
 public:
  /// Throws InputError if another process is at this shard.
  Attempt(const std::filesystem::path& shard, const std::filesystem::path& session);
  ~Attempt();
  Attempt(const Attempt&) = delete;
  Attempt& operator=(const Attempt&) = delete;
  void progress(const CampaignProgress&);  ///< called often; beats every kBeat
  void end(const std::string& why);

 private:
  void beat();
  std::filesystem::path file_;
  std::chrono::steady_clock::time_point start_, last_;
  Beat now_;
};

}  // namespace taut::cluster
