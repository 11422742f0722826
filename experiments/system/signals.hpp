#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>

/// The one handler of SIGINT, SIGTERM, SIGHUP and SIGQUIT. It kills the processes that this one
/// started, removes its temporary files and ends the program with kInterruptedExit; while a
/// GracefulStop lives, the first signal is only noted. It is installed by the first thing that
/// needs it.
namespace taut {

inline constexpr int kInterruptedExit = 130;

/// Thrown by work that a GracefulStop ended early and that has nothing whole to give.
struct Interrupted {};

/// While one lives, the first signal only sets requested(); a second one ends the program.
class GracefulStop {
 public:
  GracefulStop();
  ~GracefulStop();
  GracefulStop(const GracefulStop&) = delete;
  GracefulStop& operator=(const GracefulStop&) = delete;
  /// Whether a signal has come since the program began.
  static bool requested();
};

/// Goes when the program is ended by a signal: for as long as it lives, a file or a folder with all
/// that is in it, or a group of processes.
class EndsWithProgram {
 public:
  explicit EndsWithProgram(std::filesystem::path);
  /// What `make` makes and returns the path of; a program that is being ended makes nothing.
  explicit EndsWithProgram(const std::function<std::filesystem::path()>& make);
  explicit EndsWithProgram(pid_t group);
  ~EndsWithProgram();
  EndsWithProgram(const EndsWithProgram&) = delete;
  EndsWithProgram& operator=(const EndsWithProgram&) = delete;
  const std::filesystem::path& path() const { return path_; }  ///< "" of a group

 private:
  std::filesystem::path path_;
  pid_t group_ = 0;
};

/// "TAUT_PROCESS_<this process>_": how a variable begins that is in the environment of every
/// process that this one started, and of all that those start; a number and "=" follow for each.
/// From the first call on, what loses its parent becomes a child of this process.
const std::string& descent();

/// Whether a variable in the environment of the process begins with `mark`.
bool has_mark(pid_t process, const std::string& mark);

/// Ends what a started process left behind, also if it left its group and session: kills and reaps
/// the children of this process that it did not start itself and whose environment has a variable
/// that begins with `mark`, until there are none.
void end_orphans(const std::string& mark);

}  // namespace taut
