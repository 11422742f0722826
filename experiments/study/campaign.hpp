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

/// Work of a case, to order cases, to share them out and to foresee the end: particles and links
/// that it visits, if parameters of these names mean what they usually mean. Never part of a
/// result.
double estimated_work(const Case&);

/// How far a campaign is.
struct CampaignProgress {
  std::size_t cases = 0;               ///< of this shard
  std::size_t reused = 0;              ///< were stored already
  std::size_t ran = 0;                 ///< have been run now
  std::size_t conflicts = 0;           ///< gave another result than the one stored
  std::size_t ended_from_outside = 0;  ///< by somebody else, so that nothing is stored of them
  std::map<Status::Kind, std::size_t> by_status;
  double work = 0, work_done = 0;  ///< estimated, of what is to be run; any unit
  bool interrupted = false;

  std::size_t done() const { return reused + ran; }
};

struct CampaignOptions {
  int jobs = 1;
  Limits limits;
  Shard shard;
  bool only_failed = false;  ///< run again what is stored as a failure, and nothing else
  bool frames = false;       ///< keep the motion too; what is stored without it is run again
  /// What has not ended by then is killed and not stored.
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
  /// After every case that was run, and about twice a second (record: nullptr).
  std::function<void(const CampaignProgress&, const Record*)> progress;
};

/// Runs those cases that the store does not have, each in a process of its own, the longest first,
/// and commits each as it ends. SIGINT and SIGTERM end it after the running cases are killed; what
/// was finished is stored. Throws InputError if results cannot be written: nothing finished is
/// lost. Unfinished at the deadline: done() < cases.
CampaignProgress run_cases(const std::vector<Case>&, Store&, const CampaignOptions&);

/// Cases, and what is stored of each once they have run.
struct CasesRun {
  std::vector<Case> cases;
  /// Nothing: not ended by the deadline, or without the motion that was asked for.
  std::vector<std::optional<Record>> records;
  CampaignProgress campaign;
};

/// run_cases(), and reads the records. Throws InputError if a result differs from one that is
/// stored.
CasesRun run_and_read(std::vector<Case>, Store&, const CampaignOptions&);

/// The same of one case. Throws Interrupted too.
std::optional<Record> run_stored(
    const Case&, Store&, const Limits& = {},
    std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max());

/// Runs a case in a process of its own, whatever is stored of it, and leaves nothing in the store.
Record run_again(const Case&, Store&, const Limits& = {});

/// What the store knows of a study.
struct StudyRecords {
  Study study;
  std::vector<Case> cases;      ///< the plan
  std::vector<Record> records;  ///< in the plan's order; cases that were not run are missing
};
StudyRecords collect(const Study&, const Store&);

}  // namespace taut
