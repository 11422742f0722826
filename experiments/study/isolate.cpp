#include "experiments/study/isolate.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <new>
#include <optional>
#include <utility>

#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record_io.hpp"
#include "experiments/case/run_case.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/results/store.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/files.hpp"
#include "experiments/system/own_words.hpp"

namespace taut {

namespace fs = std::filesystem;

namespace {

/// Largest file of a case beside its motion [bytes], so that a case that prints endlessly does not
/// fill the disk.
constexpr std::size_t kFileBytes = std::size_t{256} << 20;

/// The program that runs the case: this one, or another of the same build.
std::string program_of(const Case& one) {
  const auto named = one.choice.entry->program;
  return sibling_program(std::string(named ? named(one.choice.params) : ""));
}

std::vector<std::string> command(const Case& one, const fs::path& folder, int frames) {
  std::vector<std::string> words{program_of(one), own_words::kCase, one.spec.scene,
                                 one.spec.solver, own_words::kInto, fs::absolute(folder)};
  for (const SceneSetting& setting : one.spec.settings)
    words.insert(words.end(), {own_words::kSet, setting.text()});
  if (frames > 0) words.insert(words.end(), {own_words::kFrames, std::to_string(frames)});
  return words;
}

/// Size of the motion if all steps are kept [bytes].
std::size_t motion_bytes(const Scene& scene, int frames) {
  const std::size_t frame = sizeof(double) + 3 * sizeof(float) * scene.start.x.size();
  return frames > 0 ? to_index(scene.steps + 1) * frame : 0;
}

}  // namespace

Heartbeat::Heartbeat(const fs::path& path) {
  const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  void* page = MAP_FAILED;
  // Allocate the block now: writing to a page without one would raise SIGBUS later.
  if (fd >= 0 && (errno = posix_fallocate(fd, 0, sizeof(Page))) == 0)
    page = mmap(nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (fd >= 0) close(fd);
  if (page == MAP_FAILED)
    throw InputError(path.string() + ": cannot write: " + std::strerror(errno));
  page_ = static_cast<volatile Page*>(page);
  page_->step = -1;
}

Heartbeat::~Heartbeat() { munmap(const_cast<Page*>(page_), sizeof(Page)); }

int Heartbeat::last(const fs::path& path) {
  int step = kCannotWrite;
  std::ifstream(path, std::ios::binary).read(reinterpret_cast<char*>(&step), sizeof step);
  return step;
}

Heartbeat::Measuring Heartbeat::last_measuring(const fs::path& path) {
  Page page{};
  std::ifstream(path, std::ios::binary).read(reinterpret_cast<char*>(&page), sizeof page);
  return {page.seconds, page.metric};
}

namespace {

/// Excludes the time of metrics from the limit of CPU time that this process has.
class SolversTimeLimit {
 public:
  SolversTimeLimit() {
    rlimit now{};
    if (getrlimit(RLIMIT_CPU, &now) != 0 || now.rlim_cur == RLIM_INFINITY) return;
    g_limit = now.rlim_cur;
    std::signal(SIGXCPU, give_a_metric_time);
  }
  ~SolversTimeLimit() {
    if (g_limit > 0) std::signal(SIGXCPU, SIG_DFL);
    g_limit = 0;
  }
  SolversTimeLimit(const SolversTimeLimit&) = delete;
  SolversTimeLimit& operator=(const SolversTimeLimit&) = delete;

  /// CPU time that all metrics may take [s].
  static double of_metrics() {
    return g_limit > 0 ? static_cast<double>(g_limit) : std::numeric_limits<double>::infinity();
  }
  static void measures(const Heartbeat::Measuring& now) {
    g_is_measuring = now.metric > 0;
    if (now.metric > 0 || g_limit == 0) return;
    const rlim_t more = static_cast<rlim_t>(std::ceil(now.seconds));
    if (std::exchange(g_more, more) != more || g_is_extended) set(g_limit + more);
    g_is_extended = false;
  }

 private:
  static void set(rlim_t seconds) {
    rlimit now{};
    getrlimit(RLIMIT_CPU, &now);
    now.rlim_cur = std::min(seconds, now.rlim_max);
    setrlimit(RLIMIT_CPU, &now);
  }
  /// A metric that is at work when time is up gets as much again, once.
  static void give_a_metric_time(int signal) {
    if (g_is_measuring && !g_is_extended) {
      g_is_extended = true;
      set(2 * g_limit + g_more);
      return;
    }
    std::signal(signal, SIG_DFL);
    raise(signal);
  }

  static inline rlim_t g_limit = 0, g_more = 0;  ///< s
  static inline volatile std::sig_atomic_t g_is_measuring = 0, g_is_extended = 0;
};

int place_of(const MetricEntry* metric) {
  if (!metric) return 0;
  return static_cast<int>(std::ranges::find(metrics(), metric) - metrics().begin()) + 1;
}

}  // namespace

IsolatedCase::IsolatedCase(const Case& one, fs::path folder, const Limits& limits, int frames)
    : case_(one),
      folder_(std::move(folder)),
      deadline_(in_seconds(limits.wall_seconds())),
      seconds_(limits.seconds),
      bytes_(limits.bytes),
      process_(command(case_, folder_, frames),
               {.errors_file = folder_ / kErrorsFile,
                .limits = {.cpu_seconds = limits.seconds,
                           .may_take_more = true,
                           .memory = limits.bytes,
                           .file_bytes = kFileBytes + motion_bytes(*case_.scene, frames)}}) {}

SteadyClock::time_point IsolatedCase::deadline() const {
  const Heartbeat::Measuring now = Heartbeat::last_measuring(folder_ / kHeartbeatFile);
  return after(deadline_, kWallPerCpu * (now.seconds + (now.metric > 0 ? seconds_ : 0)));
}

std::optional<Record> IsolatedCase::poll() {
  if (!process_.poll() && (SteadyClock::now() < deadline_ || SteadyClock::now() < deadline()))
    return {};
  return wait();
}

Record IsolatedCase::wait() {
  pollfd ended{process_.descriptor(), POLLIN, 0};
  while (!process_.poll()) {
    const double left = seconds_until(std::max(deadline_, deadline()));
    if (left <= 0) break;
    ::poll(&ended, 1, static_cast<int>(std::min(1e3 * left + 1, 1e6)));
  }
  Record record = record_of(process_.wait(0));
  const std::optional<ProcessEnd> end = process_.poll();
  spent_ = {end ? end->cpu : 0, Heartbeat::last_measuring(folder_ / kHeartbeatFile).seconds};
  std::error_code ignored;
  fs::remove(folder_ / kHeartbeatFile, ignored);
  if (fs::file_size(folder_ / kErrorsFile, ignored) == 0)
    fs::remove(folder_ / kErrorsFile, ignored);
  if (!record.status.is_result()) fs::remove(folder_ / kSeriesFile, ignored);
  return record;
}

void IsolatedCase::fail_from_outside(const std::string& how) const {
  throw EndedFromOutside(case_.id + ": was " + how + " from outside; no result is stored");
}

Record IsolatedCase::record_of(const std::optional<ProcessEnd>& end) const {
  using Kind = Status::Kind;
  const int beat = Heartbeat::last(folder_ / kHeartbeatFile), step = std::max(beat, -1);
  const std::string said = printable(last_line(std::ifstream(folder_ / kErrorsFile)));
  const auto failed = [&](Kind kind, const std::string& reason) {
    return unfinished(case_, {kind, reason, step, -1});
  };
  // What is not the case's fault leaves no record, since a record would count as the case's result.
  if (!fs::exists(folder_))
    throw InputError(folder_.string() + ": vanished while its case was running");
  if (!end && process_.was_stopped()) fail_from_outside("stopped");
  const int metric = Heartbeat::last_measuring(folder_ / kHeartbeatFile).metric;
  if ((!end || end->signal == SIGXCPU) && metric > 0 && metric <= std::ssize(metrics()))
    return failed(Kind::error, "the metric '" + std::string(metrics()[to_index(metric - 1)]->name) +
                                   "' takes longer than the solver may");
  if (!end) return failed(Kind::timeout, "wall time");
  if (end->from_outside(bytes_)) fail_from_outside("ended (" + end->text() + ")");
  if (end->exit_code == kEndedFromOutside) throw EndedFromOutside(case_.id + ": " + said);
  if (end->exit_code == kCannotWrite && beat == Heartbeat::kCannotWrite)
    throw InputError(said.empty() ? folder_.string() + ": cannot write: " + std::strerror(ENOSPC)
                                  : said);  // on a full disk its message is lost too
  if (end->signal == SIGXCPU) return failed(Kind::timeout, "CPU time");
  if (end->signal == SIGKILL) return failed(Kind::oom, "killed by the system");
  if (end->signal != 0) return failed(Kind::crash, end->text() + (said.empty() ? "" : ": " + said));
  switch (end->exit_code) {
    case 0: {
      Record record;
      try {
        record = record_from_json(read_text(folder_ / kRecordFile), kRecordFile);
      } catch (const InputError& error) {
        return failed(Kind::error, error.what());
      }
      // the key is what this process expects, not what the case claims
      if (record.key != case_.key)
        throw InputError(case_.id + ": " + program_of(case_) +
                         " was built from other sources than this program; build both");
      return record;
    }
    case kOutOfMemory:
      return failed(Kind::oom, "more than the limit of " + std::to_string(bytes_ >> 20) +
                                   " MB (taut run --memory raises it)");
    default:
      return failed(Kind::error, said.empty() ? end->text() : said);
  }
}

int run_into(const Case& one, const fs::path& folder, int frames) try {
  std::signal(SIGXFSZ, SIG_DFL);  // the signal ends a case that prints endlessly
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
  if (!write([&] { heartbeat.emplace(folder / kHeartbeatFile); })) return kCannotWrite;
  const fs::path motion = folder / kFramesFile;
  if (frames > 0 && !write([&] { write_file(motion, ""); })) return kCannotWrite;
  const int steps = one.scene->steps, stride = std::max(1, steps / std::max(1, frames));
  const SolversTimeLimit limit;
  const auto watch = [&](const Snapshot& m) {
    heartbeat->beat(m.step);
    if (frames > 0 && (m.step % stride == 0 || m.step == steps))
      append(motion, frame_bytes({m.t, {m.state.x, {}}}));
  };
  const auto tell = [&](const MetricEntry* metric, double seconds) {
    const Heartbeat::Measuring now{seconds, place_of(metric)};
    heartbeat->measures(now);
    SolversTimeLimit::measures(now);
  };
  const CaseRun run = run_case(one, {.series_rows = kSeriesRows,
                                     .watch = watch,
                                     .measuring = {SolversTimeLimit::of_metrics(), tell}});
  const bool written = write([&] {
    write_file(folder / kSeriesFile, to_json(run.series));
    write_file(folder / kRecordFile, to_json(run.record, 1) + "\n");
  });
  if (!written) heartbeat->beat(Heartbeat::kCannotWrite);
  return written ? 0 : kCannotWrite;
} catch (const std::bad_alloc&) {
  return kOutOfMemory;
} catch (const EndedFromOutside& error) {
  std::cerr << error.what() << '\n';
  return kEndedFromOutside;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}

}  // namespace taut
