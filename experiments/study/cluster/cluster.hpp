#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/case/case.hpp"
#include "experiments/results/session.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/isolate.hpp"
#include "experiments/study/study.hpp"

// A cluster folder holds a study with its scene files, a job script that runs one shard of it, and
// a results.db in which `planned` names every case with its shard. The results of shard 3 are in
// shards/0003, a results folder as any.
namespace taut::cluster {

/// What the job script of a folder has to know.
struct Plan {
  std::string study, preset;
  int shards = 1;
  Limits limits;  ///< of a case
  std::size_t cases = 0;
  double longest = 0;           ///< estimate of the longest shard, one case after the other [s]
  std::size_t case_memory = 0;  ///< estimate of the largest case [bytes]
};

/// Most shards of a folder: one less than Slurm's default MaxArraySize.
inline constexpr int kMostShards = 1000;

/// Estimate for one case [s]: what starting a process takes, and 15 ns for each visit. A round
/// number; limits leave room for twice that.
double estimated_seconds(double work);

/// `shards` of 0: as few as each end within so many hours. Throws InputError: more shards than
/// cases, or a case that may take longer.
Plan plan(const Study&, const std::vector<Case>&, const Limits&, int shards, double hours);

/// Where a shard keeps its results: a store.
std::filesystem::path shard_folder(const std::filesystem::path& folder, int shard);

/// Who starts the shards of a folder.
enum class Scheduler { slurm, parallel };

/// Time that Slurm gives each shard [minutes]: twice the estimate of the longest one, and what a
/// single case may take, so that every start finishes at least one case.
int shard_minutes(const Plan&);

/// The text of job.sh. Called with numbers of shards it runs those, else all; it names nothing of
/// the machine that wrote it: the program is $TAUT, or `taut` of the PATH.
std::string job_script(const Plan&, Scheduler);

/// The README of a folder: five lines.
std::string readme(const Plan&, Scheduler);

/// What a new folder is made of.
struct FolderRequest {
  Study study;
  Limits limits;
  int shards = 0;    ///< 0: as `hours` asks for
  double hours = 0;  ///< 0: one
  Scheduler on = Scheduler::slurm;
  std::string nodes = {};  ///< lines of the file `nodes`; "": there is none
};

/// Writes all of a folder: the study with scene files of the user's own and their meshes where the
/// copy of the study finds them, what is planned, job.sh. Whatever throws leaves nothing behind:
/// InputError as plan(), or of a scene file outside of the current folder.
Plan write_folder(const std::filesystem::path& folder, const FolderRequest&);

/// How far a cluster folder is: facts `cases`, `done`, `start` (the command that starts what is not
/// done) and `again` (that runs failures again); tables `shards` and `failed`. Throws InputError
/// if it is not one.
Answer status_of(const std::filesystem::path& folder);

/// What a merge of some folders would find.
struct MergePlan {
  std::vector<PlannedKey> cases;       ///< planned
  std::vector<PlannedKey> missing;     ///< planned, in no folder
  std::vector<std::string> foreign;    ///< sentences: planned or stored by one folder alone
  std::vector<std::string> conflicts;  ///< sentences: results that differ, and where they are

  bool mergeable() const { return foreign.empty() && conflicts.empty(); }
};

/// Folders of `taut cluster submit`, or results folders of `taut run --shard`, that belong
/// together.
class Merge {
 public:
  /// Throws InputError: a folder without results, or damaged ones.
  explicit Merge(const std::vector<std::filesystem::path>& folders);
  /// Compares them with each other and with what is in `into`. Changes nothing.
  MergePlan look(const Store& into) const;
  /// Copies the planned records, and who computed them, one store after the other; `progress`
  /// counts cases. Throws InputError if the disk refuses: the same merge again goes on.
  void copy(const MergePlan&, Store& into,
            const std::function<void(std::size_t done, std::size_t all)>& progress) const;

 private:
  struct Source {
    std::filesystem::path folder;
    std::vector<PlannedKey> cases;
    std::vector<Store> stores;
  };
  /// What a planned and b did not.
  static void note_planned_alone(const Source& a, const Source& b,
                                 std::vector<std::string>& foreign);
  std::vector<Source> sources_;
};

}  // namespace taut::cluster
