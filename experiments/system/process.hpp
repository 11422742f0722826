#pragma once

#include <sys/types.h>

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/input_error.hpp"
#include "experiments/system/signals.hpp"

namespace taut {

/// What a process may use; 0: as much as this one.
struct ProcessLimits {
  double cpu_seconds = 0;      ///< SIGXCPU, and SIGKILL a second later
  std::size_t memory = 0;      ///< bytes of private data; address space alone costs nothing
  std::size_t file_bytes = 0;  ///< of each file that it writes
};

struct ProcessOptions {
  enum class Stream { none, inherited, piped };
  Stream input = Stream::none, output = Stream::none;
  Stream errors = Stream::none;       ///< piped: into the pipe of the output
  std::filesystem::path errors_file;  ///< standard error is appended to it
  std::filesystem::path folder;       ///< where it runs; empty: where this one does
  ProcessLimits limits;
};

/// How a process ended.
struct ProcessEnd {
  int exit_code = -1;  ///< -1: a signal ended it
  int signal = 0;
  std::size_t peak_bytes = 0;  ///< the largest size of its resident set
  bool good() const { return exit_code == 0; }
  /// Whether somebody else ended it: by a signal that asks to end (a program that it interrupted
  /// says so by its exit code), or by SIGKILL although it had less than half of the memory that it
  /// may use. The system that runs out of memory kills what has much of it.
  bool from_outside(std::size_t memory) const;
  std::string text() const;  ///< "SIGSEGV" or "exit code 3"
};

/// Somebody else ended a process: that is no property of what it was to do, and no result of it.
struct EndedFromOutside : InputError {
  using InputError::InputError;
};

/// The last line of what a program said that is not blank, its first 300 bytes.
std::string last_line(std::istream&&);

/// A program that this one started, in a session and a process group of its own: Ctrl-C reaches
/// this process alone. All that it started dies with it, what left the group too (unless that has
/// emptied its environment), and with this process (kill -9 spares what that program started).
class Process {
 public:
  /// words[0] is a path or the name of a program in PATH. Throws InputError with the system's
  /// reason if it cannot be started.
  explicit Process(std::vector<std::string> words, const ProcessOptions& = {});
  ~Process();  ///< kills what still runs
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return pid_; }  ///< until it is reaped
  /// Ready for reading when it has ended.
  int descriptor() const { return descriptor_; }
  /// Whether a signal had stopped it (SIGSTOP) when its time was up.
  bool was_stopped() const { return was_stopped_; }
  /// How it ended; nothing while it runs.
  std::optional<ProcessEnd> poll();
  /// Waits for its end. Nothing if it still ran after these seconds (< 0: no limit) and was killed.
  std::optional<ProcessEnd> wait(double seconds = -1);

  /// To its standard input; false once it no longer reads (never a SIGPIPE), or has not read all of
  /// it after so many seconds (< 0: no limit).
  bool write(std::string_view bytes, double seconds = -1);
  void close_input();
  /// A line of its output without the line feed; false if it ended first, the seconds passed (< 0:
  /// no limit), or the line is longer than `most` bytes.
  bool read_line(std::string&, double seconds = -1, std::size_t most = std::string::npos);
  /// Exactly that many bytes of its output; false if it ended first or the seconds passed.
  bool read_bytes(std::string&, std::size_t bytes, double seconds);
  /// What has come of its output and was not read.
  std::string_view unread() const { return buffer_; }
  /// Its output to the end, or what came of it within these seconds (< 0: no limit).
  std::string read_all(double seconds = -1);
  /// Whether something lives that it started.
  bool has_descendants() const;

 private:
  /// More output into buffer_; false: there is no more, or none until the time is up.
  bool read_more(double seconds);
  std::string take(std::size_t bytes);  ///< off buffer_
  ProcessEnd reap();
  bool is_stopped() const;
  void stop();

  pid_t pid_ = -1;
  std::string mark_;  ///< in the environment of all that it starts
  int descriptor_ = -1, input_ = -1, output_ = -1;
  std::optional<ProcessEnd> end_;
  bool was_stopped_ = false;
  std::unique_ptr<EndsWithProgram> with_program_;
  std::string buffer_;
};

/// Whether a folder of $PATH has the program.
bool on_path(const std::string& program);

/// A word of a POSIX shell command, quoted if it needs to be.
std::string shell_word(const std::string&);

}  // namespace taut
