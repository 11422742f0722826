#include "experiments/system/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "core/model/input_error.hpp"
#include "experiments/system/clock.hpp"

namespace taut {

namespace {

using Stream = ProcessOptions::Stream;

/// The system's error in a largest resident set [bytes].
constexpr std::size_t kPeakError = std::size_t{1} << 20;

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}
std::size_t peak_of(const rusage& used) { return static_cast<std::size_t>(used.ru_maxrss) * 1024; }

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() {
    if (fd_ >= 0) close(fd_);
  }
  int get() const { return fd_; }
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

[[noreturn]] void fail_start(const std::string& program, int error) {
  throw InputError(program + ": cannot be executed: " + std::strerror(error));
}

/// Both ends of the child's standard streams, and of a pipe that reports why it could not start.
struct Pipes {
  Descriptor input, child_input, output, child_output, failed, child_failed;

  Pipes(const std::string& program, const ProcessOptions& options) {
    int ends[2];
    if (options.input == Stream::piped) {  // a socket, since writing to it raises no SIGPIPE
      if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail_start(program, errno);
      input = Descriptor(ends[0]);
      child_input = Descriptor(ends[1]);
    }
    if (options.output == Stream::piped || options.errors == Stream::piped) {
      if (pipe2(ends, O_CLOEXEC) != 0) fail_start(program, errno);
      output = Descriptor(ends[0]);
      child_output = Descriptor(ends[1]);
    }
    if (pipe2(ends, O_CLOEXEC) != 0) fail_start(program, errno);
    failed = Descriptor(ends[0]);
    child_failed = Descriptor(ends[1]);
  }
};

/// Ends the child between fork and exec, and tells the parent the error through a pipe.
[[noreturn]] void give_up(const Pipes& pipes) {
  const int error = errno;
  [[maybe_unused]] const auto written = write(pipes.child_failed.get(), &error, sizeof error);
  _exit(127);
}

/// Becomes the new program. Runs between fork and exec, so it may only make system calls.
[[noreturn]] void become(char* const* argv, char* const* variables, const ProcessOptions& options,
                         const Pipes& pipes, int errors_file, pid_t parent) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXFSZ}) std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  setsid();
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  const auto limit = [](auto what, double most, rlim_t grace, bool may_be_raised = false) {
    if (most <= 0) return;
    const auto soft = static_cast<rlim_t>(std::ceil(most));
    rlimit both{soft, soft + grace}, inherited{};
    if (may_be_raised && getrlimit(what, &inherited) == 0)
      both.rlim_max = std::max(both.rlim_max, inherited.rlim_max);
    setrlimit(what, &both);
  };
#ifndef TAUT_SANITIZED  // the sanitizer's shadow memory takes terabytes
  limit(RLIMIT_DATA, static_cast<double>(options.limits.memory), 0);
#endif
  limit(RLIMIT_CPU, options.limits.cpu_seconds, 1, options.limits.may_take_more);
  limit(RLIMIT_FSIZE, static_cast<double>(options.limits.file_bytes), 0);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const int null = open("/dev/null", O_RDWR | O_CLOEXEC);
  const auto connect = [&](Stream stream, int pipe, int as) {
    if (stream != Stream::inherited) dup2(stream == Stream::piped ? pipe : null, as);
  };
  connect(options.input, pipes.child_input.get(), STDIN_FILENO);
  connect(options.output, pipes.child_output.get(), STDOUT_FILENO);
  connect(options.errors, pipes.child_output.get(), STDERR_FILENO);
  if (errors_file >= 0) dup2(errors_file, STDERR_FILENO);
  if (!options.folder.empty() && chdir(options.folder.c_str()) != 0) give_up(pipes);
  execvpe(argv[0], argv, variables);
  give_up(pipes);
}

/// The environment of this process, with `mark` added.
std::vector<char*> environment_with(std::string& mark) {
  std::vector<char*> variables{mark.data()};
  for (char** at = environ; *at; ++at) variables.push_back(*at);
  variables.push_back(nullptr);
  return variables;
}

/// The rest of a time limit of `seconds` that ends at `end`; negative (no limit) stays negative.
double left(SteadyClock::time_point end, double seconds) {
  return seconds < 0 ? -1 : std::max(0.0, seconds_until(end));
}

/// Timeout for poll(): at most an hour, after which the caller looks at the clock again.
int milliseconds_until(SteadyClock::time_point end, double seconds) {
  return seconds < 0 ? -1 : static_cast<int>(std::ceil(1e3 * std::min(left(end, seconds), 3600.0)));
}

}  // namespace

std::string ProcessEnd::text() const {
  if (signal == 0) return "exit code " + std::to_string(exit_code);
  const char* name = sigabbrev_np(signal);
  return name ? "SIG" + std::string(name) : "signal " + std::to_string(signal);
}

bool ProcessEnd::from_outside(std::size_t memory) const {
  if (signal == SIGKILL) return memory == 0 || peak_bytes < memory / 2;
  return signal == SIGTERM || signal == SIGINT || signal == SIGHUP || signal == SIGQUIT ||
         exit_code == kInterruptedExit;
}

std::string last_line(std::istream&& in) {
  std::string last;
  for (std::string line; std::getline(in, line);)
    if (line.find_first_not_of(" \t\r") != line.npos) last = line.substr(0, 300);
  return last;
}

Process::Process(std::vector<std::string> words, const ProcessOptions& options) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  static std::atomic<int> started{0};
  mark_ = descent() + std::to_string(++started) + "=";
  const std::vector<char*> variables = environment_with(mark_);
  Pipes pipes(words.front(), options);
  Descriptor errors_file;
  if (!options.errors_file.empty()) {
    errors_file = Descriptor(
        open(options.errors_file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
    if (errors_file.get() < 0)
      throw InputError(options.errors_file.string() + ": cannot write: " + std::strerror(errno));
  }
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);  // no signal handler of ours may run in the child
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) become(argv.data(), variables.data(), options, pipes, errors_file.get(), parent);
  const int fork_error = errno;
  rusage own{};
  getrusage(RUSAGE_SELF, &own);
  inherited_ = peak_of(own);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (pid_ < 0) fail_start(words.front(), fork_error);

  with_program_ = std::make_unique<EndsWithProgram>(pid_);
  descriptor_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  pipes.child_failed = Descriptor();
  int error = descriptor_ < 0 ? errno : 0;
  ssize_t got = 0;
  while (error == 0 && (got = read(pipes.failed.get(), &error, sizeof error)) < 0 && errno == EINTR)
    error = 0;
  input_ = pipes.input.release();
  output_ = pipes.output.release();
  if (error == 0) return;
  stop();
  fail_start(words.front(), error);
}

Process::~Process() { stop(); }

void Process::stop() {
  if (!end_) {
    kill(pid_, SIGKILL);
    reap();
  }
  for (int* fd : {&descriptor_, &input_, &output_})
    if (*fd >= 0) close(std::exchange(*fd, -1));
}

ProcessEnd Process::reap() {
  siginfo_t info{};  // waits without reaping, so that no other group can take over the number
  while (waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
  }
  kill(-pid_, SIGKILL);
  int status = 0;
  rusage used{};
  while (wait4(pid_, &status, 0, &used) < 0 && errno == EINTR) {
  }
  with_program_.reset();
  end_orphans(mark_);
  end_ = WIFEXITED(status) ? ProcessEnd{WEXITSTATUS(status), 0} : ProcessEnd{-1, WTERMSIG(status)};
  // exec() does not forget what the copy of this process held: only a larger peak is its own.
  const std::size_t peak = peak_of(used);
  end_->peak_bytes = peak > inherited_ + kPeakError ? peak : 0;
  end_->cpu = seconds(used.ru_utime) + seconds(used.ru_stime);
  return *end_;
}

bool Process::is_stopped() const {
  std::ifstream file("/proc/" + std::to_string(pid_) + "/stat");
  std::string line;
  std::getline(file, line);
  const auto name_ends = line.rfind(')');
  return !end_ && name_ends != line.npos && line.substr(name_ends).starts_with(") T");
}

std::optional<ProcessEnd> Process::poll() {
  if (end_) return end_;
  siginfo_t info{};
  if (waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
      info.si_pid == 0)
    return {};
  return reap();
}

std::optional<ProcessEnd> Process::wait(double seconds) {
  const auto end = in_seconds(seconds);
  pollfd ended{descriptor_, POLLIN, 0};
  while (!end_ && ::poll(&ended, 1, milliseconds_until(end, seconds)) <= 0 &&
         (seconds < 0 || SteadyClock::now() < end)) {
  }
  if (poll()) return end_;
  was_stopped_ = is_stopped();
  kill(pid_, SIGKILL);
  reap();
  return {};
}

bool Process::write(std::string_view bytes, double seconds) {
  const auto end = in_seconds(seconds);
  while (!bytes.empty()) {
    const ssize_t sent = send(input_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(sent));
      continue;
    }
    pollfd ready{input_, POLLOUT, 0};
    if (errno == EAGAIN && ::poll(&ready, 1, milliseconds_until(end, seconds)) == 0 &&
        SteadyClock::now() >= end)
      return false;
    if (errno != EAGAIN && errno != EINTR) return false;
  }
  return true;
}

bool Process::has_descendants() const {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
    const pid_t pid = std::atoi(entry.path().filename().c_str());
    if (pid > 0 && pid != pid_ && has_mark(pid, mark_)) return true;
  }
  return false;
}

void Process::close_input() {
  if (input_ >= 0) close(std::exchange(input_, -1));
}

bool Process::read_more(double seconds) {
  const auto end = in_seconds(seconds);
  for (;;) {
    pollfd ready[] = {{output_, POLLIN, 0}, {end_ ? -1 : descriptor_, POLLIN, 0}};
    const int count = ::poll(ready, 2, end_ ? 0 : milliseconds_until(end, seconds));
    if (count < 0 && errno == EINTR) continue;
    if (ready[0].revents != 0) {
      char piece[65536];
      const ssize_t got = read(output_, piece, sizeof piece);
      if (got < 0 && errno == EINTR) continue;
      if (got > 0) buffer_.append(piece, static_cast<std::size_t>(got));
      return got > 0;
    }
    if (count == 0 && !end_ && (seconds < 0 || SteadyClock::now() < end)) continue;
    if (count <= 0) return false;
    poll();  // It has ended. Kill what else holds its end of the pipe, then read what is left.
  }
}

std::string Process::take(std::size_t bytes) {
  std::string taken = buffer_.substr(0, bytes);
  buffer_.erase(0, bytes);
  return taken;
}

bool Process::read_line(std::string& line, double seconds, std::size_t most) {
  const auto end = in_seconds(seconds);
  std::size_t length, seen = 0;
  while ((length = buffer_.find('\n', seen)) == buffer_.npos) {
    seen = buffer_.size();
    if (seen > most || !read_more(left(end, seconds))) return false;
  }
  line = take(length + 1);
  line.pop_back();
  return true;
}

bool Process::read_bytes(std::string& text, std::size_t bytes, double seconds) {
  const auto end = in_seconds(seconds);
  while (buffer_.size() < bytes)
    if (!read_more(left(end, seconds))) return false;
  text = take(bytes);
  return true;
}

std::string Process::read_all(double seconds) {
  const auto end = in_seconds(seconds);
  while (read_more(left(end, seconds))) {
  }
  return std::exchange(buffer_, {});
}

bool on_path(const std::string& program) {
  std::istringstream folders(std::getenv("PATH") ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

std::string shell_word(const std::string& text) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-=:,./+@%";
  if (!text.empty() && text.find_first_not_of(kPlain) == text.npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace taut
