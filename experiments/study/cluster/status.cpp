#include <algorithm>

#include "experiments/study/cluster/cluster.hpp"
#include "experiments/study/store.hpp"

namespace taut::cluster {

namespace fs = std::filesystem;

std::string_view to_string(ShardStatus::State state) {
  constexpr std::string_view kNames[] = {"done", "running", "lost", "stopped", "waiting"};
  return kNames[static_cast<int>(state)];
}

std::vector<int> FolderStatus::to_start() const {
  std::vector<int> numbers;
  for (const ShardStatus& one : shards)
    if (one.state != ShardStatus::State::done && one.state != ShardStatus::State::running)
      numbers.push_back(one.shard);
  return numbers;
}

std::optional<double> FolderStatus::seconds() const {
  std::optional<double> longest;
  for (const ShardStatus& one : shards)
    if (one.seconds) longest = std::max(longest.value_or(0), *one.seconds);
  return longest;
}

FolderStatus status_of(const Manifest& manifest, const fs::path& folder) {
  FolderStatus all;
  all.cases = manifest.cases.size();
  std::vector<Beats> silent;
  for (int i = 1; i <= manifest.shards; ++i) {
    ShardStatus one;
    one.shard = i;
    if (fs::exists(shard_folder(folder, i) / "beats")) one.state = ShardStatus::State::stopped;
    all.shards.push_back(one);
    std::ranges::copy(not_ended(shard_folder(folder, i)), std::back_inserter(silent));
  }
  const auto shard_of = [&](const Beats& beats) -> ShardStatus& {
    const std::string name = beats.file.parent_path().parent_path().filename();
    return all.shards[static_cast<std::size_t>(std::stoi(name)) - 1];
  };
  for (const Beats& beats : silent)
    shard_of(beats).state = ShardStatus::State::lost, shard_of(beats).host = beats.last.host;
  for (const Beats& beats : living(silent)) {
    ShardStatus& one = shard_of(beats);
    one.state = ShardStatus::State::running, one.host = beats.last.host;
    if (beats.last.work_done > 0)
      one.seconds =
          (beats.last.work - beats.last.work_done) / beats.last.work_done * beats.last.seconds;
  }
  std::vector<Store> stores;  // after the beats: what ended in between counts as done
  for (int i = 1; i <= manifest.shards; ++i) stores.emplace_back(shard_folder(folder, i));
  for (const PlannedCase& planned : manifest.cases) {
    const auto shard = static_cast<std::size_t>(planned.shard) - 1;
    ++all.shards[shard].cases;
    const std::optional<Record> record = stores[shard].find(planned.key);
    if (!record) continue;
    ++all.shards[shard].done, ++all.done;
    if (!record->status.is_result())
      all.failed.push_back({planned.shard, planned.id, record->status});
  }
  for (ShardStatus& one : all.shards)
    if (one.done == one.cases && one.state != ShardStatus::State::running)
      one.state = ShardStatus::State::done;
  return all;
}

}  // namespace taut::cluster
