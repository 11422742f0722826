#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/study/isolate.hpp"
#include "experiments/study/study.hpp"

namespace taut::cluster {

/// A case of a manifest.
struct PlannedCase {
  std::string key, id;
  CaseSpec spec;  ///< a scene file is relative to the cluster folder
  int shard = 1;
  double work = 0;  ///< estimated_work
};

/// What a cluster folder is to compute, and by which build. On disk: manifest.jsonl, a line about
/// the study, then one for each case.
struct Manifest {
  std::string study, preset;
  std::string build;   ///< program_digest of the program that planned it
  std::string digest;  ///< SHA-256 of the lines of the cases
  int shards = 1;
  Limits limits;                   ///< of a case
  std::size_t case_memory = 0;     ///< estimate for the largest case, bytes
  std::vector<PlannedCase> cases;  ///< in the order of the study

  double seconds_of(int shard) const;  ///< estimate, one case after the other
};

/// Most shards of a folder: one less than Slurm's default MaxArraySize.
inline constexpr int kMostShards = 1000;

/// Estimate for one case [s]: what starting a process takes, and 15 ns for each visit. A round
/// number to share out by; limits leave room for twice that.
double estimated_seconds(double work);

/// Assigns every case to one of the manifest's shards so that their estimates are even: the longest
/// first, each to the shard that has least.
void share_out(Manifest&);

/// The cases of a study. Copies scene files of the user's own, with their meshes, into
/// <folder>/scenes: a folder is whole in itself. Throws InputError.
Manifest plan(const Study&, const Limits&, const std::filesystem::path& folder);

/// The file's text; sets the digest.
std::string manifest_text(Manifest&);

/// Throws InputError with file and line: not there, damaged, of another version.
Manifest read_manifest(const std::filesystem::path& folder);

/// The cases of one shard, ready to run. Throws InputError if this build is not the manifest's, if
/// there is no such shard, or if a scene is no longer what was planned.
std::vector<Case> cases_of(const Manifest&, int shard, const std::filesystem::path& folder);

/// Where a shard keeps its results: a store.
std::filesystem::path shard_folder(const std::filesystem::path& folder, int shard);

}  // namespace taut::cluster
