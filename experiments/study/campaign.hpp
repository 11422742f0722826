#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/results/session.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/isolate.hpp"
#include "experiments/study/study.hpp"

namespace taut {

/// Estimated work of a case: the particles and links that it visits, if parameters have their usual
/// meaning. It is used to order cases, to share them out and to predict the end, but never affects
/// a result.
double estimated_work(const Case&);

/// Progress of a campaign.
struct CampaignProgress {
  std::size_t cases = 0;               ///< in this shard
  std::size_t reused = 0;              ///< already stored
  std::size_t ran = 0;                 ///< run by this campaign
  std::size_t conflicts = 0;           ///< gave another result than the stored one
  std::size_t ended_from_outside = 0;  ///< ended by something outside and not stored
  std::map<Status::Kind, std::size_t> by_status;
  double work = 0, work_done = 0;  ///< estimated work of the cases to run, in any unit
  bool interrupted = false;

  std::size_t done() const { return reused + ran; }
};

struct CampaignOptions {
  int jobs = 1;
  Limits limits;
  Shard shard;
  bool only_failed = false;  ///< rerun cases stored as failures, and nothing else
  bool frames = false;       ///< keep the motion too, and rerun cases stored without it
  /// Cases that have not ended by then are killed and not stored.
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
  /// Called after every case that was run, and about twice a second with a null record.
  std::function<void(const CampaignProgress&, const Record*)> progress;
};

/// Runs the cases that the store does not have, the longest first, each in a process of its own,
/// and commits each as it ends. SIGINT and SIGTERM end the campaign and kill the running cases;
/// finished cases are stored. Throws InputError if results cannot be written; nothing that was
/// committed is lost. If cases are unfinished at the deadline, done() < cases.
CampaignProgress run_cases(const std::vector<Case>&, Store&, const CampaignOptions&);

/// Cases, and their stored records after a run.
struct CasesRun {
  std::vector<Case> cases;
  /// Nothing for a case that did not end by the deadline, or that lacks the requested motion.
  std::vector<std::optional<Record>> records;
  CampaignProgress campaign;
};

/// Calls run_cases() and reads the records. Throws InputError if a result differs from a stored
/// one.
CasesRun run_and_read(std::vector<Case>, Store&, const CampaignOptions&);

/// run_and_read() for one case. Also throws Interrupted.
std::optional<Record> run_stored(
    const Case&, Store&, const Limits& = {},
    std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max());

/// Runs a case in a process of its own, whether it is stored or not. Stores nothing.
Record run_again(const Case&, Store&, const Limits& = {});

/// Stored records of a study.
struct StudyRecords {
  Study study;
  std::vector<Case> cases;      ///< all planned cases
  std::vector<Record> records;  ///< in the order of the plan; cases that were not run are missing
};
StudyRecords collect(const Study&, const Store&);

}  // namespace taut
