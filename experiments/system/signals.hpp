#pragma once

#include <sys/types.h>

#include <filesystem>

/// The one handler of SIGINT, SIGTERM and SIGHUP. It kills the processes that this one started,
/// removes its temporary files and ends the program with kInterruptedExit; while a GracefulStop
/// lives, the first signal is only noted. It is installed by the first thing that needs it.
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
  explicit EndsWithProgram(pid_t group);
  ~EndsWithProgram();
  EndsWithProgram(const EndsWithProgram&) = delete;
  EndsWithProgram& operator=(const EndsWithProgram&) = delete;

 private:
  std::filesystem::path path_;
  pid_t group_ = 0;
};

}  // namespace taut
