#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/study/cluster/manifest.hpp"

namespace taut::cluster {

/// How far a shard is.
struct ShardStatus {
  enum class State {
    done,     ///< every case has a record
    running,  ///< it said something while this looked
    lost,     ///< it began, did not end and is silent: killed, or its node is gone
    stopped,  ///< it ended before all was done: a signal, an error
    waiting   ///< nobody began it
  };
  int shard = 0;
  State state = State::waiting;
  std::size_t cases = 0, done = 0;
  std::string host;               ///< of who runs it or was lost
  std::optional<double> seconds;  ///< estimate of what is left at its pace; nothing: not running
};
std::string_view to_string(ShardStatus::State);

/// A case that ended without a result.
struct FailedCase {
  int shard = 0;
  std::string id;
  Status status;
};

struct FolderStatus {
  std::vector<ShardStatus> shards;
  std::vector<FailedCase> failed;
  std::size_t cases = 0, done = 0;

  std::vector<int> to_start() const;      ///< lost, stopped and waiting
  std::optional<double> seconds() const;  ///< the longest of those that run
  bool complete() const { return done == cases; }
};

/// Looks at a cluster folder. Waits up to patience() for shards that neither ended nor speak.
/// Throws InputError.
FolderStatus status_of(const Manifest&, const std::filesystem::path& folder);

}  // namespace taut::cluster
