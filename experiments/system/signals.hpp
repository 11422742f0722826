#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>

/// The only handler of SIGINT, SIGTERM, SIGHUP and SIGQUIT. It kills the processes that this one
/// started, removes its temporary files and ends the program with kInterruptedExit. While a
/// GracefulStop lives, the first signal is only recorded. The first object that needs the handler
/// installs it.
namespace taut {

inline constexpr int kInterruptedExit = 130;

/// Thrown by work that a GracefulStop ended before it had a complete result.
struct Interrupted {};

/// While one lives, the first signal only sets requested(); a second one ends the program.
class GracefulStop {
 public:
  GracefulStop();
  ~GracefulStop();
  GracefulStop(const GracefulStop&) = delete;
  GracefulStop& operator=(const GracefulStop&) = delete;
  /// Whether a signal has arrived since the program began.
  static bool requested();
};

/// While this object lives, a signal that ends the program also removes a file or a folder with its
/// contents, or kills a group of processes.
class EndsWithProgram {
 public:
  explicit EndsWithProgram(std::filesystem::path);
  /// Registers the path that `make` creates and returns. `make` is not called once the program is
  /// ending.
  explicit EndsWithProgram(const std::function<std::filesystem::path()>& make);
  explicit EndsWithProgram(pid_t group);
  ~EndsWithProgram();
  EndsWithProgram(const EndsWithProgram&) = delete;
  EndsWithProgram& operator=(const EndsWithProgram&) = delete;
  const std::filesystem::path& path() const { return path_; }  ///< "" for a group

 private:
  std::filesystem::path path_;
  pid_t group_ = 0;
};

/// "TAUT_PROCESS_<pid of this process>_", followed by a number and "=": the start of an environment
/// variable that all descendants of this process have. From the first call on, orphaned descendants
/// become children of this process.
const std::string& descent();

/// Whether the environment of the process has a variable that begins with `mark`.
bool has_mark(pid_t process, const std::string& mark);

/// Ends all processes that a started process left behind, also outside its group and session. Until
/// none is left, kills and reaps children of this process that it did not start itself and whose
/// environment has a variable that begins with `mark`.
void end_orphans(const std::string& mark);

}  // namespace taut
