#include "experiments/system/signals.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <mutex>
#include <set>
#include <thread>

namespace taut {

namespace {

std::atomic<int> g_signals{0}, g_graceful{0};
int g_wake[2] = {-1, -1};  ///< a pipe from the handler to the thread that may do what it may not

/// What goes with the program; never destroyed, for the thread outlives main().
struct Belongings {
  std::mutex mutex;
  std::multiset<std::filesystem::path> paths;
  std::multiset<pid_t> groups;
};
Belongings& belongings() {
  static Belongings& all = *new Belongings;
  return all;
}

void on_signal(int) {
  const int before = errno;
  ++g_signals;
  [[maybe_unused]] const auto written = write(g_wake[1], "", 1);
  errno = before;
}

[[noreturn]] void end_program() {
  Belongings& all = belongings();
  const std::lock_guard lock(all.mutex);  // kept: nothing new is registered any more
  for (const pid_t group : all.groups) kill(-group, SIGKILL);
  std::error_code ignored;
  for (const auto& path : all.paths)
    for (int attempt = 0; attempt < 3; ++attempt)  // another thread may still be writing there
      std::filesystem::remove_all(path, ignored);
  _exit(kInterruptedExit);
}

void serve_signals() {
  for (char byte;;)
    if (read(g_wake[0], &byte, 1) == 1 && (g_graceful == 0 || g_signals > 1)) end_program();
}

void install_handler() {
  static std::once_flag once;
  std::call_once(once, [] {
    if (pipe2(g_wake, O_CLOEXEC) != 0) return;
    belongings();
    std::thread(serve_signals).detach();
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      struct sigaction old {};
      sigaction(signal, nullptr, &old);
      if (old.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);  // nohup stays nohup
    }
  });
}

}  // namespace

GracefulStop::GracefulStop() {
  install_handler();
  ++g_graceful;
}

GracefulStop::~GracefulStop() { --g_graceful; }

bool GracefulStop::requested() { return g_signals > 0; }

EndsWithProgram::EndsWithProgram(std::filesystem::path path) : path_(std::move(path)) {
  install_handler();
  const std::lock_guard lock(belongings().mutex);
  belongings().paths.insert(path_);
}

EndsWithProgram::EndsWithProgram(pid_t group) : group_(group) {
  install_handler();
  const std::lock_guard lock(belongings().mutex);
  belongings().groups.insert(group_);
}

EndsWithProgram::~EndsWithProgram() {
  const std::lock_guard lock(belongings().mutex);
  if (group_ > 0)
    belongings().groups.extract(group_);
  else
    belongings().paths.extract(path_);
}

}  // namespace taut
