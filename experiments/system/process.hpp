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

/// Wall seconds that a process may take for each second of CPU time that it may use: a busy machine
/// also runs other processes.
inline constexpr double kWallPerCpu = 5;

/// Limits on a process; 0: the same as this process.
struct ProcessLimits {
  double cpu_seconds = 0;      ///< SIGXCPU at the limit, SIGKILL a second later
  bool may_take_more = false;  ///< it may raise cpu_seconds itself: no SIGKILL
  std::size_t memory = 0;      ///< bytes of private data; address space alone does not count
  std::size_t file_bytes = 0;  ///< size of each file that it writes
};

struct ProcessOptions {
  enum class Stream { none, inherited, piped };
  Stream input = Stream::none, output = Stream::none;
  Stream errors = Stream::none;       ///< piped: joins the output's pipe
  std::filesystem::path errors_file;  ///< standard error is appended to this file
  std::filesystem::path folder;       ///< working folder; empty: that of this process
  ProcessLimits limits;
};

/// How a process ended.
struct ProcessEnd {
  int exit_code = -1;  ///< -1 if a signal ended it
  int signal = 0;
  std::size_t peak_bytes = 0;  ///< largest resident set; 0 if the starting process's was as large
  double cpu = 0;              ///< s, of the process and of those that it waited for
  bool good() const { return exit_code == 0; }
  /// Whether something outside ended it: a signal that asks it to end (a taut process reports that
  /// by its exit code), or SIGKILL while it used less than half of `memory`, its limit. A system
  /// that runs out of memory kills processes that use much of it.
  bool from_outside(std::size_t memory) const;
  std::string text() const;  ///< "SIGSEGV" or "exit code 3"
};

/// Thrown if something outside ended a process. That is not a result of the work it was to do.
struct EndedFromOutside : InputError {
  using InputError::InputError;
};

/// Last line that is not blank, cut to 300 bytes.
std::string last_line(std::istream&&);

/// A program that this one started, in a session and a process group of its own, so that Ctrl-C
/// reaches only this process. When it ends, all its descendants are killed, also those that left
/// the group (unless they emptied their environment). It is killed when this process ends; kill -9
/// of this process spares its descendants.
class Process {
 public:
  /// Starts words[0], a path or the name of a program in PATH. Throws InputError with the system's
  /// reason if it cannot be started.
  explicit Process(std::vector<std::string> words, const ProcessOptions& = {});
  ~Process();  ///< kills it if it still runs
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return pid_; }  ///< valid until it is reaped
  /// Descriptor that becomes readable when the process ends.
  int descriptor() const { return descriptor_; }
  /// Whether it was stopped by a signal (SIGSTOP) when its time was up.
  bool was_stopped() const { return was_stopped_; }
  /// How it ended; nothing while it runs.
  std::optional<ProcessEnd> poll();
  /// Waits for its end. Kills it and returns nothing if it still runs after `seconds` (< 0: no
  /// limit).
  std::optional<ProcessEnd> wait(double seconds = -1);

  /// Writes to its standard input. False if it has stopped reading (never a SIGPIPE), or has not
  /// read everything within `seconds` (< 0: no limit).
  bool write(std::string_view bytes, double seconds = -1);
  void close_input();
  /// Reads a line of its output, without the line feed. False if the output ended, `seconds` passed
  /// (< 0: no limit), or the line is longer than `most` bytes.
  bool read_line(std::string&, double seconds = -1, std::size_t most = std::string::npos);
  /// Reads exactly this number of bytes. False if the output ended or `seconds` passed.
  bool read_bytes(std::string&, std::size_t bytes, double seconds);
  /// Output that has arrived but was not read.
  std::string_view unread() const { return buffer_; }
  /// Reads its output to the end, or for `seconds` (< 0: no limit).
  std::string read_all(double seconds = -1);
  /// Whether any process that it started is alive.
  bool has_descendants() const;

 private:
  /// Reads more output into buffer_. False if the output ended or nothing arrived in time.
  bool read_more(double seconds);
  std::string take(std::size_t bytes);  ///< removes and returns the front of buffer_
  ProcessEnd reap();
  bool is_stopped() const;
  void stop();

  pid_t pid_ = -1;
  std::string mark_;  ///< a variable in the environment of all its descendants
  int descriptor_ = -1, input_ = -1, output_ = -1;
  std::size_t inherited_ = 0;  ///< largest resident set of this process at the start [bytes]
  std::optional<ProcessEnd> end_;
  bool was_stopped_ = false;
  std::unique_ptr<EndsWithProgram> with_program_;
  std::string buffer_;
};

/// Whether a folder in $PATH contains the program.
bool on_path(const std::string& program);

/// A text as one word of a POSIX shell command, quoted if necessary.
std::string shell_word(const std::string&);

}  // namespace taut
