#include "experiments/timing/timing.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <ctime>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "core/model/input_error.hpp"
#include "experiments/system/data.hpp"

extern char** environ;

namespace taut {

namespace {

double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Adds the time of its life to a StepTime.
class Clock {
 public:
  explicit Clock(StepTime& into) : into_(into) {}
  ~Clock() {
    into_.cpu += seconds_of(CLOCK_PROCESS_CPUTIME_ID) - cpu_;
    into_.wall += seconds_of(CLOCK_MONOTONIC) - wall_;
  }
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;

 private:
  StepTime& into_;
  double wall_ = seconds_of(CLOCK_MONOTONIC);
  double cpu_ = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
};

StepTime operator/(const StepTime& t, int steps) { return {t.cpu / steps, t.wall / steps}; }

/// One line of the worker's answers, read byte by byte: the pipe holds no more than it.
bool read_line(int fd, std::string& line) {
  line.clear();
  for (char c = 0; read(fd, &c, 1) == 1;) {
    if (c == '\n') return true;
    line += c;
  }
  return false;
}

}  // namespace

double time_steps(const Scene& scene, Solver& solver, int steps) {
  solver.load(scene.start);
  solver.step(0, scene.dt);
  solver.load(scene.start);
  StepTime time;
  {
    const Clock clock(time);
    for (int n = 0; n < steps; ++n) solver.step(n * scene.dt, scene.dt);
  }
  return time.cpu / steps;
}

Rehearsal::Rehearsal(const Scene& scene, Solver& solver, int steps) : dt_(scene.dt) {
  const int starts = std::clamp(steps / 8, 1, 4);
  length_ = std::max(1, steps / starts);
  solver.load(scene.start);
  for (int n = 0; n < steps; ++n) {
    if (n % length_ == 0 && static_cast<int>(starts_.size()) < starts) {
      starts_.push_back({n, {}});
      solver.store(starts_.back().state);
    }
    const Clock clock(whole_);
    solver.step(n * dt_, dt_);
  }
  whole_ = whole_ / std::max(1, steps);
}

StepTime Rehearsal::sample(Solver& solver, int steps) const {
  const int share = std::clamp(steps / static_cast<int>(starts_.size()), 1, length_);
  StepTime time;
  for (const Start& start : starts_) {
    solver.load(start.state);
    solver.step(start.step * dt_, dt_);
    solver.load(start.state);
    const Clock clock(time);
    for (int n = start.step; n < start.step + share; ++n) solver.step(n * dt_, dt_);
  }
  return time / (share * static_cast<int>(starts_.size()));
}

int serve_timing(const Scene& scene, const SolverChoice& choice) {
  const std::unique_ptr<Solver> solver = choice.entry->make(scene, choice.params);
  std::cout.precision(17);
  std::cout << "ready" << std::endl;
  std::optional<Rehearsal> run;
  std::string word;
  while (std::cin >> word) {
    int steps = 0;
    StepTime time;
    if (word == "rehearse" && std::cin >> steps) {
      run.emplace(scene, *solver, std::max(1, steps));
      time = run->whole();
      std::cout << time.cpu << ' ' << time.wall << std::endl;
    } else if (word == "time" && run && std::cin >> steps) {
      time = run->sample(*solver, steps);
      std::cout << time.cpu << ' ' << time.wall << std::endl;
    } else {
      rusage usage{};
      getrusage(RUSAGE_SELF, &usage);
      std::cout << usage.ru_maxrss * 1024 << std::endl;
    }
  }
  return 0;
}

TimingWorker::TimingWorker(const std::filesystem::path& program, const CaseSpec& spec) {
  std::signal(SIGPIPE, SIG_IGN);
  std::vector<std::string> words{program.string(), "bench", "--worker", spec.scene, spec.solver};
  for (const std::string& value : spec.overrides) words.insert(words.end(), {"--set", value});
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  int in[2], out[2];
  if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0)
    throw std::runtime_error("no pipe for a worker");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  const int error = posix_spawn(&pid_, program.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(in[0]), close(out[1]);
  to_ = in[1], from_ = out[0];
  std::string line;
  if (error != 0 || !read_line(from_, line) || line != "ready")
    throw std::runtime_error("the timing worker of " + spec.scene + " " + spec.solver +
                             " did not start");
}

TimingWorker::~TimingWorker() {
  close(to_);
  close(from_);
  if (pid_ > 0) waitpid(pid_, nullptr, 0);
}

std::string TimingWorker::ask(const std::string& request) {
  const std::string line = request + "\n";
  std::string answer;
  if (write(to_, line.data(), line.size()) != static_cast<ssize_t>(line.size()) ||
      !read_line(from_, answer))
    throw std::runtime_error("the timing worker died");
  return answer;
}

StepTime TimingWorker::ask_time(const std::string& line) {
  std::istringstream answer(ask(line));
  StepTime time;
  answer >> time.cpu >> time.wall;
  return time;
}

StepTime TimingWorker::rehearse(int steps) { return ask_time("rehearse " + std::to_string(steps)); }

StepTime TimingWorker::sample(int steps) { return ask_time("time " + std::to_string(steps)); }

std::size_t TimingWorker::peak_bytes() { return std::stoull(ask("memory")); }

namespace {

/// A case in a bench: its worker, how many steps make a sample, and what was measured.
struct Lane {
  std::unique_ptr<TimingWorker> worker;
  int steps = 0;
  Timing timing;

  void guard(const std::function<void()>& action) {
    if (!timing.failure.empty()) return;
    try {
      action();
    } catch (const std::exception& error) {
      timing.failure = error.what();
      worker.reset();
    }
  }
};

Lane open_lane(const CaseSpec& spec, const BenchOptions& options) {
  Lane lane;
  lane.timing.spec = spec;
  lane.guard([&] {
    lane.worker = std::make_unique<TimingWorker>(options.program(spec), spec);
    const int all = std::max(1, options.steps(spec));
    const double pilot = lane.worker->rehearse(all).cpu;
    lane.steps = std::clamp(
        static_cast<int>(std::min(options.seconds / std::max(pilot, 1e-9), 1e9)), 1, all);
  });
  return lane;
}

}  // namespace

std::filesystem::path program_of(const CaseSpec& spec) {
  const SolverChoice choice = parse_solver(spec.solver);
  return sibling_program(choice.entry->program ? std::string(choice.entry->program(choice.params))
                                               : "");
}

int steps_done(const Record& record) {
  return record.status.step > 0 ? record.status.step : record.steps;
}

std::string machine_name() {
  std::ifstream info("/proc/cpuinfo");
  std::string line, model = "unknown processor";
  while (std::getline(info, line))
    if (line.starts_with("model name")) {
      model = line.substr(line.find(':') + 2);
      break;
    }
  return model + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores";
}

Interval Bench::ratio(std::size_t i, std::size_t j) const {
  return interleaved_ratio(timings[i].samples, timings[j].samples);
}

Bench run_bench(const std::vector<CaseSpec>& specs, const BenchOptions& options) {
  std::vector<Lane> lanes;
  for (const CaseSpec& spec : specs) lanes.push_back(open_lane(spec, options));
  if (!specs.empty()) {
    lanes.push_back(open_lane(specs.front(), options));  // the A/A control
    lanes.back().steps = lanes.front().steps;
  }
  const auto sample = [](Lane& lane) {
    lane.guard([&] {
      const StepTime time = lane.worker->sample(lane.steps);
      lane.timing.samples.push_back(time.cpu);
      lane.timing.wall.push_back(time.wall);
    });
  };
  for (int round = 0; round < options.rounds; ++round) {
    std::for_each(lanes.begin(), lanes.end(), sample);
    std::for_each(lanes.rbegin(), lanes.rend(), sample);
    if (options.progress)
      options.progress(static_cast<std::size_t>(round) + 1,
                       static_cast<std::size_t>(options.rounds));
  }
  Bench bench;
  for (Lane& lane : lanes) {
    lane.guard([&] { lane.timing.peak_bytes = lane.worker->peak_bytes(); });
    bench.timings.push_back(std::move(lane.timing));
  }
  if (specs.empty()) return bench;
  const Timing control = std::move(bench.timings.back());
  bench.timings.pop_back();
  if (control.failure.empty() && bench.timings.front().failure.empty())
    bench.control = interleaved_ratio(bench.timings.front().samples, control.samples);
  return bench;
}

}  // namespace taut
