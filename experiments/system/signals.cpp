#include "experiments/system/signals.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "core/model/text.hpp"

namespace taut {

namespace {

std::atomic<int> g_signals{0}, g_graceful{0};
/// Pipe from the handler to a thread that may do what a signal handler may not.
int g_wake[2] = {-1, -1};

/// What to remove or kill when the program ends. Never destroyed, since the thread outlives main().
struct ExitCleanup {
  std::mutex mutex;
  std::multiset<std::filesystem::path> paths;
  std::multiset<pid_t> groups;
};
ExitCleanup& exit_cleanup() {
  static ExitCleanup& all = *new ExitCleanup;
  return all;
}

void on_signal(int) {
  const int before = errno;
  ++g_signals;
  [[maybe_unused]] const auto written = write(g_wake[1], "", 1);
  errno = before;
}

std::vector<pid_t> children() {
  std::vector<pid_t> all;
  std::error_code none;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task", none)) {
    std::ifstream list(thread.path() / "children");
    for (std::string child; list >> child;)
      if (const auto id = whole<pid_t>(child)) all.push_back(*id);
  }
  return all;
}

/// Whether a process has no environment because it is ending or is a kernel thread. Source:
/// proc(5), "stat".
bool is_no_program(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string line, state, skipped;
  std::getline(file, line);
  std::istringstream fields(line.substr(std::min(line.size(), line.rfind(')') + 1)));
  constexpr unsigned long kExiting = 0x4, kKernelThread = 0x200000;
  std::string word;
  fields >> state >> skipped >> skipped >> skipped >> skipped >> skipped >> word;
  const unsigned long flags = whole<unsigned long>(word).value_or(kExiting);
  return state == "Z" || (flags & (kExiting | kKernelThread)) != 0;
}

/// Kills and reaps children whose environment has the mark. Precondition: the caller holds the
/// mutex of exit_cleanup().
void end_children(const std::string& mark) {
  for (bool found = true; found;) {
    found = false;
    for (const pid_t child : children()) {
      if (exit_cleanup().groups.contains(child)) continue;
      const bool ours = has_mark(child, mark);
      if (ours) kill(child, SIGKILL);
      found = found || ours;
      // A dead child has no environment, so it counts as not ours, but is reaped as well.
      waitpid(child, nullptr, ours ? 0 : WNOHANG);
    }
  }
}

[[noreturn]] void end_program() {
  ExitCleanup& all = exit_cleanup();
  const std::lock_guard lock(all.mutex);  // never released: nothing new can be registered
  for (const pid_t group : all.groups) kill(-group, SIGKILL);
  for (const pid_t group : all.groups)
    for (int ms = 0; ms < 1000 && waitpid(group, nullptr, WNOHANG) == 0; ++ms) usleep(1000);
  end_children(descent());
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
    exit_cleanup();
    std::thread(serve_signals).detach();
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
      struct sigaction old {};
      sigaction(signal, nullptr, &old);
      // A signal that nohup ignores stays ignored.
      if (old.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
    }
  });
}

}  // namespace

bool has_mark(pid_t process, const std::string& mark) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    std::ifstream file("/proc/" + std::to_string(process) + "/environ", std::ios::binary);
    const std::string variables{std::istreambuf_iterator<char>(file), {}};
    if (variables.starts_with(mark) || variables.find('\0' + mark) != variables.npos) return true;
    if (!file.is_open() || !variables.empty() || is_no_program(process)) return false;
    usleep(100);  // in the middle of an execve() the environment reads as empty
  }
  return false;
}

const std::string& descent() {
  static const std::string mark = [] {
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    return "TAUT_PROCESS_" + std::to_string(getpid()) + "_";
  }();
  return mark;
}

void end_orphans(const std::string& mark) {
  const std::lock_guard lock(exit_cleanup().mutex);
  end_children(mark);
}

GracefulStop::GracefulStop() {
  install_handler();
  ++g_graceful;
}

GracefulStop::~GracefulStop() { --g_graceful; }

bool GracefulStop::requested() { return g_signals > 0; }

EndsWithProgram::EndsWithProgram(std::filesystem::path path) : path_(std::move(path)) {
  install_handler();
  const std::lock_guard lock(exit_cleanup().mutex);
  exit_cleanup().paths.insert(path_);
}

EndsWithProgram::EndsWithProgram(const std::function<std::filesystem::path()>& make) {
  install_handler();
  const std::lock_guard lock(exit_cleanup().mutex);
  exit_cleanup().paths.insert(path_ = make());
}

EndsWithProgram::EndsWithProgram(pid_t group) : group_(group) {
  install_handler();
  const std::lock_guard lock(exit_cleanup().mutex);
  exit_cleanup().groups.insert(group_);
}

EndsWithProgram::~EndsWithProgram() {
  const std::lock_guard lock(exit_cleanup().mutex);
  if (group_ > 0)
    exit_cleanup().groups.extract(group_);
  else
    exit_cleanup().paths.extract(path_);
}

}  // namespace taut
