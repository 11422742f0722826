#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/case/record.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/isolate.hpp"
#include "experiments/study/session.hpp"
#include "experiments/study/store.hpp"
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

/// Who starts the shards of a folder.
enum class Scheduler { slurm, parallel };

/// Time that Slurm gives each shard [minutes]: twice the estimate of the longest one, and what a
/// single case may take, so that every start finishes at least one case.
int shard_minutes(const Manifest&);

/// Fewest shards, each of which ends within so many hours. Throws InputError if one case may not.
int shards_for(const Manifest&, double hours);

/// The text of job.sh. Called with numbers of shards it runs those, else all; it names nothing of
/// the machine that wrote it: the program is $TAUT, or `taut` of the PATH.
std::string job_script(const Manifest&, Scheduler);

/// The README of a folder: five lines.
std::string readme(const Manifest&, Scheduler);

/// A start of a shard says every two seconds that it is alive: a line in a file of its own in
/// <shard>/beats. Whoever wants to know reads twice and looks for new lines, so no clock of one
/// host is ever compared with that of another, and nothing is locked.
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
  std::string host, started;        ///< who and when, by its own clock
};

/// The beats of one start of a shard.
struct Beats {
  std::filesystem::path file;
  std::size_t count = 0;
  Beat last;
};

/// Those starts of a shard that have not ended. Throws InputError: damaged.
std::vector<Beats> not_ended(const std::filesystem::path& shard);

/// Reads again until all of them have said more or ended, or patience is over; gives the starts
/// that have (which live) as they are now.
std::vector<Beats> living(const std::vector<Beats>&);

/// This process's start of a shard.
class Attempt {
 public:
  /// Throws InputError if another process is at this shard.
  explicit Attempt(const std::filesystem::path& shard);
  /// The same under this name, which tells two starts apart.
  Attempt(const std::filesystem::path& shard, const std::string& name);
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
  /// Throws InputError: a folder without results, a manifest that is damaged.
  explicit Merge(const std::vector<std::filesystem::path>& folders);
  /// Compares them with each other and with what is in `into`. Changes nothing.
  MergePlan look(const Store& into) const;
  /// Copies the planned records, and who computed them, one store after the other; `progress`
  /// counts cases. Throws InputError if the disk refuses: the same merge again goes on.
  void copy(const MergePlan&, const Store& into,
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
