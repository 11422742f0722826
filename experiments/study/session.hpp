#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/study/store.hpp"

namespace taut {

/// Part i of n of a list of cases, by key, so that adding cases does not reshuffle the others.
struct Shard {
  int index = 1;  ///< 1 to count
  int count = 1;
  bool has(const std::string& key) const;
  /// "i/n"; empty: what a Slurm array says ($SLURM_ARRAY_TASK_ID, _MIN, _COUNT), else the whole.
  /// Throws InputError.
  static Shard parse(const std::string&);
};

/// Who ran what: makes a folder of the store that only this process writes, and gives it. Throws
/// InputError if it cannot be written.
///     session.json     command, time, host, versions, shard
///     manifest.jsonl   every case, of all shards: {"key", "id", "shard", "shards"}
std::filesystem::path begin_session(const Store&, const std::string& command,
                                    const std::vector<Case>& = {}, const Shard& = {});

/// A line of a manifest.
struct ManifestEntry {
  std::string key, id;
  int shard = 1, shards = 1;
};

std::string to_text(const ManifestEntry&);  ///< a line

/// Throws InputError with file and line.
std::vector<ManifestEntry> read_manifest_lines(const std::filesystem::path& file);

/// What the sessions of a results folder were to run, each key once. Throws InputError with file
/// and line.
std::vector<ManifestEntry> read_manifests(const std::filesystem::path& root);

/// Marks a results folder: these cases were planned and are not there. The mark stands in
/// <root>/missing/<name>.jsonl; reports show it until the cases come. Throws InputError.
void mark_missing(const std::filesystem::path& root, const std::string& name,
                  const std::vector<ManifestEntry>&);

/// A mark that still holds.
struct Missing {
  std::filesystem::path file;
  std::vector<std::string> ids;  ///< of cases that the store still lacks
  std::size_t cases = 0;         ///< that lacked when it was marked
  std::string sentence() const;
};
/// Throws InputError with file and line.
std::vector<Missing> still_missing(const Store&);

}  // namespace taut
