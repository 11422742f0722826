#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "experiments/case/case.hpp"
#include "experiments/case/record.hpp"
#include "experiments/system/process.hpp"

namespace taut {

/// What one case may use.
struct Limits {
  double seconds = 120;  ///< CPU time; wall time may be five times as much (a busy machine)
  std::size_t bytes = std::size_t{2} << 30;  ///< memory of its own
};

/// Exit code by which a case says that it ran out of memory.
inline constexpr int kOutOfMemory = 77;
/// Exit code by which a case says, with its heartbeat, that its folder cannot be written: the
/// campaign ends, for a full disk is no property of the case that meets it.
inline constexpr int kCannotWrite = 74;

/// Exit code by which a case says that its solver's own program was ended from outside.
inline constexpr int kEndedFromOutside = 78;

/// The step that a case has reached, in a file that outlives it: 4 bytes, mapped, so that reporting
/// costs a store to memory.
class Heartbeat {
 public:
  explicit Heartbeat(const std::filesystem::path&);  ///< throws InputError if it cannot be made
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;
  void beat(int step) { *step_ = step; }
  static constexpr int kCannotWrite = -2;  ///< instead of a step: the folder cannot be written
  /// What the file says; -1: nothing yet; kCannotWrite if there is no such file.
  static int last(const std::filesystem::path&);

 private:
  volatile int* step_;
};

/// One case in a process of its own: `taut case SCENE SOLVER --into FOLDER`, or the sibling program
/// that its solver needs. Whatever it does (crash, hang, allocate without end) costs that process.
/// It dies with this process, however this one ends.
class IsolatedCase {
 public:
  /// Starts it; its files and its output go into `folder`, with about `frames` moments of its
  /// motion (kFramesFile). Throws InputError if it cannot start.
  IsolatedCase(const Case&, std::filesystem::path folder, const Limits&, int frames = 0);

  /// Ready for reading when the process has ended.
  int descriptor() const { return process_.descriptor(); }
  /// Its record once it has ended or its time is up (it is killed then); until then nothing.
  /// Throws InputError if it could not write what it found, and EndedFromOutside if somebody else
  /// stopped or ended it.
  std::optional<Record> poll();
  Record wait();  ///< the same, when it has ended or its time is up
  const std::filesystem::path& folder() const { return folder_; }
  const Case& of() const { return case_; }

 private:
  /// `end`: nothing if its time was up.
  Record record_of(const std::optional<ProcessEnd>& end) const;
  [[noreturn]] void fail_from_outside(const std::string& how) const;
  Case case_;
  std::filesystem::path folder_;
  std::chrono::steady_clock::time_point deadline_;
  std::size_t bytes_;
  Process process_;
};

/// The child's side: runs the case in this process and leaves case.json, series.json, its heartbeat
/// and about `frames` moments of its motion in `folder`. Returns the exit code.
int run_into(const Case&, const std::filesystem::path& folder, int frames = 0);

}  // namespace taut
