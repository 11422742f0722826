#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "experiments/case/case.hpp"
#include "experiments/case/record.hpp"
#include "experiments/results/store.hpp"
#include "experiments/system/process.hpp"

namespace taut {

/// Resources that one case may use.
struct Limits {
  double seconds = 120;                      ///< CPU time of the solver; metrics may take as much
  std::size_t bytes = std::size_t{2} << 30;  ///< private memory

  double wall_seconds() const { return kWallPerCpu * seconds; }
};

/// Exit code of a case that ran out of memory.
inline constexpr int kOutOfMemory = 77;
/// Exit code of a case that, as its heartbeat confirms, cannot write into its folder. The campaign
/// then ends, since a full disk is not the fault of the case that encounters it.
inline constexpr int kCannotWrite = 74;

/// Exit code of a case whose solver's own program was ended from outside.
inline constexpr int kEndedFromOutside = 78;

/// File of a case's Heartbeat, in its folder while it runs.
inline constexpr const char* kHeartbeatFile = "heartbeat";

/// The step that a case has reached, and what its metrics do. It is kept in a small mapped file
/// that outlives the case, so that reporting costs one store to memory.
class Heartbeat {
 public:
  struct Measuring {
    double seconds = 0;  ///< CPU time of all metrics until now
    int metric = 0;      ///< the one at work, its place in metrics() from 1; 0: none is
  };
  explicit Heartbeat(const std::filesystem::path&);  ///< throws InputError if it cannot be made
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;
  void beat(int step) { page_->step = step; }
  void measures(const Measuring& now) {
    page_->seconds = now.seconds;
    page_->metric = now.metric;
  }
  static constexpr int kCannotWrite = -2;  ///< in place of a step: the folder cannot be written
  /// The step in the file; -1: none yet; kCannotWrite if there is no such file.
  static int last(const std::filesystem::path&);
  static Measuring last_measuring(
      const std::filesystem::path&);  ///< zeros if there is no such file

 private:
  struct Page {
    int step, metric;
    double seconds;
  };
  volatile Page* page_;
};

/// A case in a process of its own: `taut case SCENE SOLVER --into FOLDER`, or the sibling program
/// that its solver needs. A crash, a hang or unbounded allocation affects only that process. The
/// process dies with this one, however this one ends.
class IsolatedCase {
 public:
  /// Starts the case. Its files and output go into `folder`, with about `frames` moments of its
  /// motion (kFramesFile). Throws InputError if it cannot start.
  IsolatedCase(const Case&, std::filesystem::path folder, const Limits&, int frames = 0);

  /// Descriptor that becomes readable when the process ends.
  int descriptor() const { return process_.descriptor(); }
  /// Its record once it has ended or its time is up, at which point it is killed; nothing before
  /// that. Throws InputError if it could not write its results, and EndedFromOutside if something
  /// outside stopped or ended it.
  std::optional<Record> poll();
  Record wait();  ///< waits for that and returns the record
  const std::filesystem::path& folder() const { return folder_; }
  const Case& of() const { return case_; }
  const Spent& spent() const { return spent_; }  ///< of a case that has ended

 private:
  /// When it has to end. The time of its metrics, and of the one at work, is not the solver's.
  std::chrono::steady_clock::time_point deadline() const;
  /// `end` is empty if its time was up.
  Record record_of(const std::optional<ProcessEnd>& end) const;
  [[noreturn]] void fail_from_outside(const std::string& how) const;
  Case case_;
  std::filesystem::path folder_;
  std::chrono::steady_clock::time_point deadline_;  ///< of a case without metrics
  double seconds_;
  std::size_t bytes_;
  Process process_;
  Spent spent_;
};

/// The child's side: runs the case in this process and writes kRecordFile, kSeriesFile, its
/// heartbeat and about `frames` moments of its motion into `folder`. Returns the exit code.
int run_into(const Case&, const std::filesystem::path& folder, int frames = 0);

}  // namespace taut
