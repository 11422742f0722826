#include "experiments/study/isolate.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iostream>
#include <new>
#include <optional>

#include "core/model/input_error.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

constexpr int kSeriesRows = 120;
constexpr rlim_t kFileBytes = rlim_t{256} << 20;  ///< a case that prints without end fills no disk

std::string reason_for(const char* what) {
  throw InputError(std::string("cannot start a case: ") + what + ": " + std::strerror(errno));
}

/// Between fork and exec: system calls only.
void restrict_child(const Limits& limits, pid_t parent, int out) {
  setpgid(0, 0);  // Ctrl-C reaches the parent alone, which ends its cases
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  const auto limit = [](auto what, rlim_t most) {
    const rlimit both{most, most + (what == RLIMIT_CPU ? 1 : 0)};  // SIGXCPU first, then SIGKILL
    setrlimit(what, &both);
  };
#ifndef __SANITIZE_ADDRESS__  // its shadow alone is terabytes of address space
  limit(RLIMIT_AS, limits.bytes);
#else
  static_cast<void>(limits);
#endif
  limit(RLIMIT_CPU, static_cast<rlim_t>(std::ceil(limits.seconds)));
  limit(RLIMIT_FSIZE, kFileBytes);
  limit(RLIMIT_CORE, 0);
  const int null = open("/dev/null", O_RDWR);
  dup2(null, STDIN_FILENO), dup2(null, STDOUT_FILENO), dup2(out, STDERR_FILENO);
}

std::string last_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line, last;
  while (std::getline(in, line))
    if (!line.empty()) last = line.substr(0, 300);
  return last;
}

std::string signal_name(int signal) {
  const char* name = sigabbrev_np(signal);
  return name ? "SIG" + std::string(name) : "signal " + std::to_string(signal);
}

}  // namespace

Heartbeat::Heartbeat(const fs::path& path) {
  const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  void* page = MAP_FAILED;
  // Room for it now: a page without a block behind it is a SIGBUS later.
  if (fd >= 0 && (errno = posix_fallocate(fd, 0, sizeof(int))) == 0)
    page = mmap(nullptr, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (fd >= 0) close(fd);
  if (page == MAP_FAILED)
    throw InputError(path.string() + ": cannot write: " + std::strerror(errno));
  step_ = static_cast<volatile int*>(page);
  *step_ = -1;
}

Heartbeat::~Heartbeat() { munmap(const_cast<int*>(step_), sizeof(int)); }

int Heartbeat::last(const fs::path& path) {
  int step = -1;
  std::ifstream(path, std::ios::binary).read(reinterpret_cast<char*>(&step), sizeof step);
  return step;
}

IsolatedCase::IsolatedCase(const Case& one, fs::path folder, const Limits& limits)
    : case_(one),
      folder_(std::move(folder)),
      deadline_(std::chrono::steady_clock::now() +
                std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                    std::chrono::duration<double>(5 * limits.seconds))) {
  const auto program_of = case_.choice.entry->program;
  program_ = sibling_program(std::string(program_of ? program_of(case_.choice.params) : ""));
  std::vector<std::string> words{program_.string(), "case",   case_.spec.scene,
                                 case_.spec.solver, "--into", folder_};
  for (const std::string& text : case_.spec.overrides) words.insert(words.end(), {"--set", text});
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const int out =
      open((folder_ / "stderr.txt").c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (out < 0) reason_for((folder_ / "stderr.txt").c_str());
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) {
    restrict_child(limits, parent, out);
    execv(program_.c_str(), argv.data());
    _exit(127);
  }
  close(out);
  if (pid_ < 0) reason_for("fork");
  fd_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  if (fd_ < 0) reason_for("pidfd_open");
}

IsolatedCase::~IsolatedCase() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  if (fd_ >= 0) close(fd_);
}

std::optional<Record> IsolatedCase::poll() {
  int wait_status = 0;
  bool timed_out = false;
  if (waitpid(pid_, &wait_status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() < deadline_) return {};
    kill(pid_, SIGKILL);
    waitpid(pid_, &wait_status, 0);
    timed_out = true;
  }
  pid_ = -1;
  Record record = record_of(wait_status, timed_out);
  std::error_code ignored;
  fs::remove(folder_ / "heartbeat", ignored);
  if (fs::file_size(folder_ / "stderr.txt", ignored) == 0)
    fs::remove(folder_ / "stderr.txt", ignored);
  if (!record.status.is_result()) fs::remove(folder_ / "series.csv", ignored);
  return record;
}

Record IsolatedCase::record_of(int wait_status, bool timed_out) const {
  using Kind = Status::Kind;
  const int step = Heartbeat::last(folder_ / "heartbeat");
  const std::string said = last_line(folder_ / "stderr.txt");
  const auto failed = [&](Kind kind, const std::string& reason) {
    return unfinished(case_, {kind, reason, step, -1});
  };
  if (timed_out) return failed(Kind::timeout, "wall time");
  if (WIFSIGNALED(wait_status)) {
    const int signal = WTERMSIG(wait_status);
    if (signal == SIGXCPU) return failed(Kind::timeout, "CPU time");
    if (signal == SIGKILL) return failed(Kind::oom, "killed by the system");
    return failed(Kind::crash, signal_name(signal) + (said.empty() ? "" : ": " + said));
  }
  switch (WEXITSTATUS(wait_status)) {
    case 0:
      try {
        return record_from_json(read_text(folder_ / "case.json"), "case.json");
      } catch (const InputError& error) {
        return failed(Kind::error, error.what());
      }
    case kOutOfMemory:
      return failed(Kind::oom, "out of memory");
    // What is no property of the case leaves no record: it would be taken for the case's result.
    case kCannotWrite:  // on a full disk its words are lost too
      throw InputError(said.empty() ? folder_.string() + ": cannot write: " + std::strerror(ENOSPC)
                                    : said);
    case 127:
      throw InputError(program_.string() + ": cannot be executed" +
                       (said.empty() ? "; was it removed while the study ran?" : ": " + said));
    default:
      return failed(Kind::error,
                    said.empty() ? "exit code " + std::to_string(WEXITSTATUS(wait_status)) : said);
  }
}

int run_into(const Case& one, const fs::path& folder) try {
  const auto write = [&](auto&& what) {
    try {
      what();
      return true;
    } catch (const InputError& error) {
      std::cerr << error.what() << '\n';
      return false;
    }
  };
  std::optional<Heartbeat> heartbeat;
  if (!write([&] { heartbeat.emplace(folder / "heartbeat"); })) return kCannotWrite;
  const CaseRun run = run_case(one, {.series_rows = kSeriesRows,
                                     .watch = [&](const Moment& m) { heartbeat->beat(m.step); }});
  const bool written = write([&] {
    write_durably(folder / "series.csv", to_csv(run.series));
    write_durably(folder / "case.json", to_json(run.record, 1) + "\n");
  });
  return written ? 0 : kCannotWrite;
} catch (const std::bad_alloc&) {
  return kOutOfMemory;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}

}  // namespace taut
