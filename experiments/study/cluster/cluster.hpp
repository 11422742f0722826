#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/case/case.hpp"
#include "experiments/results/session.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/isolate.hpp"
#include "experiments/study/study.hpp"

// A cluster folder contains a study with its scene files, a job script that runs one shard of it,
// and a results.db whose table `planned` lists every case with its shard. The results of shard 3
// are in shards/0003, an ordinary results folder.
namespace taut::cluster {

/// The data for the job script of a folder.
struct Plan {
  std::string study, preset;
  int shards = 1;
  Limits limits;  ///< limits of a case
  std::size_t cases = 0;
  double longest = 0;  ///< estimate for the longest shard, with its cases run one after another [s]
  std::size_t case_memory = 0;  ///< estimate for the largest case [bytes]
};

/// Most shards of a folder: one less than Slurm's default MaxArraySize.
inline constexpr int kMostShards = 1000;

/// Estimated time of one case [s]: the start of a process, and 15 ns per visit. The numbers are
/// rough; time limits allow twice the estimate.
double estimated_seconds(double work);

/// Plans the shards. If `shards` is 0, plans the fewest that each end within `hours`. Throws
/// InputError if there are more shards than cases, or a single case may take longer.
Plan plan(const Study&, const std::vector<Case>&, const Limits&, int shards, double hours);

/// Results folder of a shard.
std::filesystem::path shard_folder(const std::filesystem::path& folder, int shard);

/// The program that starts the shards of a folder.
enum class Scheduler { slurm, parallel };
std::string_view to_string(Scheduler);
/// The one that to_string() calls this; nothing for another name.
std::optional<Scheduler> scheduler_named(std::string_view);

/// Time limit of each shard under Slurm [minutes]: twice the estimate for the longest shard, plus
/// the limit of a single case, so that every start finishes at least one case.
int shard_minutes(const Plan&);

/// Text of job.sh. It runs the shards whose numbers it is called with, or all. It does not depend
/// on the machine that wrote it: the program is $TAUT, or `taut` in the PATH.
std::string job_script(const Plan&, Scheduler);

/// README of a folder, in five lines.
std::string readme(const Plan&, Scheduler);

/// Parameters of a new folder.
struct FolderRequest {
  Study study;
  Limits limits;
  int shards = 0;  ///< 0: determined by `hours`
  double hours = 1;
  Scheduler on = Scheduler::slurm;
  std::string nodes = {};  ///< lines of the file `nodes`; "": no such file
};

/// Writes a folder: the study, the user's own scene files and meshes where the copy of the study
/// finds them, the plan, the name of the scheduler, and job.sh. Leaves nothing behind if it throws:
/// InputError as from plan(), or if a scene file lies outside the current folder.
Plan write_folder(const std::filesystem::path& folder, const FolderRequest&);

/// Progress of a cluster folder: facts `cases`, `done`, `start` (the command that starts what is
/// not done) and `again` (the command that reruns failures), and tables `shards` and `failed`.
/// Throws InputError if it is not a cluster folder.
Answer status_of(const std::filesystem::path& folder);

/// Findings of a merge of folders before it writes anything.
struct MergePlan {
  std::vector<PlannedKey> cases;       ///< planned
  std::vector<PlannedKey> missing;     ///< planned, but not stored in any folder
  std::vector<std::string> foreign;    ///< sentences: cases planned or stored by only one folder
  std::vector<std::string> conflicts;  ///< sentences: results that differ, and where they are

  bool mergeable() const { return foreign.empty() && conflicts.empty(); }
};

/// Folders of `taut cluster submit`, or results folders of `taut run --shard`, that belong
/// together.
class Merge {
 public:
  /// Throws InputError if a folder has no results or damaged ones.
  explicit Merge(const std::vector<std::filesystem::path>& folders);
  /// Compares the folders with each other and with `into`. Changes nothing.
  MergePlan look(const Store& into) const;
  /// Copies the planned records and their sessions, one store after another. `progress` counts
  /// cases. Throws InputError if the disk refuses; the same merge can then be repeated to complete
  /// it.
  void copy(const MergePlan&, Store& into,
            const std::function<void(std::size_t done, std::size_t all)>& progress) const;

 private:
  struct Source {
    std::filesystem::path folder;
    std::vector<PlannedKey> cases;
    std::vector<Store> stores;
  };
  /// Adds what a planned and b did not.
  static void note_planned_alone(const Source& a, const Source& b,
                                 std::vector<std::string>& foreign);
  std::vector<Source> sources_;
};

}  // namespace taut::cluster
