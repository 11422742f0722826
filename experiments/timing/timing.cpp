#include "experiments/timing/timing.hpp"

#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <thread>

#include "core/model/text.hpp"
#include "experiments/system/clock.hpp"
#include "experiments/system/data.hpp"
#include "experiments/system/own_words.hpp"
#include "experiments/system/run_all.hpp"
#include "experiments/timing/interleave.hpp"

namespace taut {

namespace {

/// Adds the time of its own lifetime to a StepTime.
class Clock {
 public:
  Clock(StepTime& into, const Solver& solver) : into_(into), solver_(solver) {}
  ~Clock() {
    into_.cpu += solver_.cpu_seconds() - cpu_;
    into_.wall += seconds_of(CLOCK_MONOTONIC) - wall_;
  }
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;

 private:
  StepTime& into_;
  const Solver& solver_;
  double wall_ = seconds_of(CLOCK_MONOTONIC);
  double cpu_ = solver_.cpu_seconds();
};

StepTime operator/(const StepTime& t, int steps) { return {t.cpu / steps, t.wall / steps}; }

// A timing worker sends kReady, then an answer to each line of a request.
constexpr std::string_view kReady = "ready 2";  ///< with the version of these lines
constexpr std::string_view kPilotRun = "pilot_run", kSample = "time", kRemark = "remark",
                           kMemory = "memory";
/// Start of a worker's answer that is an error instead of a time.
constexpr std::string_view kRefusal = "! ";

std::vector<std::string> worker_command(const CaseSpec& spec,
                                        const std::filesystem::path& program) {
  std::vector<std::string> words{program.empty() ? program_of(spec) : program, own_words::kBench,
                                 own_words::kWorker, spec.scene, spec.solver};
  for (const SceneSetting& setting : spec.settings)
    words.insert(words.end(), {own_words::kSet, setting.text()});
  return words;
}

}  // namespace

CheckpointedRun::CheckpointedRun(const Scene& scene, Solver& solver, int steps) : dt_(scene.dt) {
  const int starts = std::clamp(steps / 8, 1, 4);
  length_ = std::max(1, steps / starts);
  solver.load(scene.start);
  for (int n = 0; n < steps; ++n) {
    if (n % length_ == 0 && static_cast<int>(starts_.size()) < starts) {
      starts_.push_back({n, {}});
      solver.store(starts_.back().state);
    }
    const Clock clock(whole_, solver);
    solver.step(n * dt_, dt_);
  }
  whole_ = whole_ / std::max(1, steps);
}

StepTime CheckpointedRun::sample(Solver& solver, int steps) const {
  const int share = std::clamp(steps / static_cast<int>(starts_.size()), 1, length_);
  StepTime time;
  for (const Start& start : starts_) {
    solver.load(start.state);
    solver.step(start.step * dt_, dt_);
    solver.load(start.state);
    const Clock clock(time, solver);
    for (int n = start.step; n < start.step + share; ++n) solver.step(n * dt_, dt_);
  }
  return time / (share * static_cast<int>(starts_.size()));
}

int serve_timing(const Scene& scene, const SolverChoice& choice) {
  if (std::getenv("SLURM_JOB_ID"))
    bind_to_cores(choice.params.has("threads") ? std::max(1, choice.params.integer("threads")) : 1);
  const std::unique_ptr<Solver> solver = choice.entry->make(scene, choice.params);
  std::cout << kReady << std::endl;
  std::optional<CheckpointedRun> run;
  std::string line;
  const auto answer = [&](const StepTime& time) {
    if (std::isnan(time.cpu)) throw std::runtime_error(solver->time_remark());
    std::cout << shortest(time.cpu) << ' ' << shortest(time.wall) << std::endl;
  };
  while (std::getline(std::cin, line)) try {
      const std::vector<std::string> request = parts_of(line, ' ');
      const std::string word = request.empty() ? "" : request[0];
      const int steps = request.size() < 2 ? 0 : whole<int>(request[1]).value_or(0);
      if (word == kPilotRun && steps > 0) {
        run.emplace(scene, *solver, steps);
        answer(run->whole());
      } else if (word == kSample && steps > 0 && run) {
        answer(run->sample(*solver, steps));
      } else if (word == kRemark) {
        std::cout << solver->time_remark() << std::endl;
      } else if (word == kMemory) {
        std::cout << solver->peak_bytes() << std::endl;
      } else {
        throw std::runtime_error("the timing worker cannot do '" + line + "'");
      }
    } catch (const std::runtime_error& error) {
      std::cout << kRefusal << error.what() << std::endl;
    }
  return 0;
}

void bind_to_cores(int cores) {
  cpu_set_t mine;
  if (sched_getaffinity(0, sizeof mine, &mine) != 0) return;
  for (int core = 0; core < CPU_SETSIZE && CPU_COUNT(&mine) > cores; ++core) CPU_CLR(core, &mine);
  sched_setaffinity(0, sizeof mine, &mine);
}

TimingWorker::TimingWorker(const CaseSpec& spec, const std::filesystem::path& program)
    : process_(worker_command(spec, program), {.input = ProcessOptions::Stream::piped,
                                               .output = ProcessOptions::Stream::piped,
                                               .errors = ProcessOptions::Stream::inherited}) {
  const std::string who = "the timing worker of " + spec.scene + " " + spec.solver;
  std::string line;
  if (!process_.read_line(line)) throw std::runtime_error(who + " did not start");
  if (line != kReady)
    throw std::runtime_error(who + " is of a build that cannot be timed beside this one");
}

std::string TimingWorker::ask(const std::string& request) {
  std::string answer;
  const double seconds = deadline_ ? std::min(seconds_until(*deadline_), 1e6) : -1;
  if (deadline_ && seconds <= 0) throw TimeIsUp();
  if (process_.write(request + "\n") && process_.read_line(answer, seconds)) {
    if (answer.starts_with(kRefusal)) throw std::runtime_error(answer.substr(kRefusal.size()));
    return answer;
  }
  if (deadline_ && SteadyClock::now() >= *deadline_) throw TimeIsUp();
  throw std::runtime_error("the timing worker died");
}

StepTime TimingWorker::ask_time(const std::string& line) {
  const std::string answer = ask(line);
  const std::vector<std::string> words = parts_of(answer, ' ');
  const auto number = [&](std::size_t k) {
    return k < words.size() ? whole<double>(words[k]) : std::nullopt;
  };
  const auto cpu = number(0), wall = number(1);
  if (!cpu || !wall) throw std::runtime_error("the timing worker answered '" + answer + "'");
  return {*cpu, *wall};
}

StepTime TimingWorker::pilot_run(int steps) {
  return ask_time(std::string(kPilotRun) + " " + std::to_string(steps));
}

StepTime TimingWorker::sample(int steps) {
  return ask_time(std::string(kSample) + " " + std::to_string(steps));
}

std::size_t TimingWorker::peak_bytes() { return std::stoull(ask(std::string(kMemory))); }

std::string TimingWorker::remark() { return ask(std::string(kRemark)); }

namespace {

/// A case in a session: its worker, the number of steps in a sample, and its samples.
struct SampledCase {
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

SampledCase start_case(const CaseToTime& timed, const TimingOptions& options) {
  SampledCase one;
  one.guard([&] {
    one.worker = std::make_unique<TimingWorker>(timed.spec, timed.program);
    if (options.deadline != SteadyClock::time_point::max())
      one.worker->give_up_at(options.deadline);
  });
  return one;
}

/// Runs a case once as a whole. Its cost determines how many steps make a sample.
void pilot(SampledCase& one, const CaseToTime& timed, const TimingOptions& options) {
  const int all = std::max(1, timed.steps);
  one.guard(
      [&] { one.steps = times_within(options.seconds, one.worker->pilot_run(all).cpu, all); });
}

/// Prepares cases for sampling. Their pilot runs use all cores at once, since their times are not
/// kept; runs side by side look more expensive, which makes samples a few steps shorter.
std::vector<SampledCase> start_cases(const std::vector<CaseToTime>& all,
                                     const TimingOptions& options) {
  std::vector<SampledCase> cases;
  for (const CaseToTime& one : all) cases.push_back(start_case(one, options));
  run_all(all.size(), static_cast<int>(std::thread::hardware_concurrency()),
          [&](std::size_t i) { pilot(cases[i], all[i], options); });
  return cases;
}

/// The A/A control: a second worker for the first case that can be timed. If that case fails on the
/// way, the next one takes its place, so that the order of the cases does not matter.
class Control {
 public:
  Control(const std::vector<CaseToTime>& all, const TimingOptions& options)
      : all_(all), options_(options) {}

  /// The worker to sample twice in the middle of each round (A B here B A).
  SampledCase& twin(const std::vector<SampledCase>& cases) {
    while (of_ < cases.size() &&
           (!started_ || !twin_.timing.failure.empty() || !cases[of_].timing.failure.empty())) {
      if (started_) ++of_;
      while (of_ < cases.size() && !cases[of_].timing.failure.empty()) ++of_;
      started_ = true;
      if (of_ == cases.size()) break;
      twin_ = start_case(all_[of_], options_);
      pilot(twin_, all_[of_], options_);
      twin_.steps = cases[of_].steps;
      skipped_ = cases[of_].timing.samples.size() / 2 * 2;  // samples of completed rounds
    }
    return twin_;
  }

  /// Ratio of the case to itself, by one clock.
  Interval ratio(const std::vector<Timing>& timings, std::vector<double> Timing::*samples) const {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    const std::vector<double>& again = twin_.timing.*samples;
    if (of_ >= timings.size() || again.empty() || !twin_.timing.failure.empty() ||
        !timings[of_].failure.empty())
      return {kNaN, kNaN, kNaN};
    return interleaved_ratio(std::span(timings[of_].*samples).subspan(skipped_), again);
  }

 private:
  const std::vector<CaseToTime>& all_;
  const TimingOptions& options_;
  bool started_ = false;
  std::size_t of_ = 0;       ///< index of the case whose twin it is
  std::size_t skipped_ = 0;  ///< samples of that case before the twin started
  SampledCase twin_;
};

}  // namespace

int times_within(double seconds, double each, int most) {
  return std::clamp(static_cast<int>(std::min(seconds / std::max(each, 1e-9), 1e9)), 1, most);
}

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

Interval TimingSession::ratio(std::size_t i, std::size_t j) const {
  return interleaved_ratio(timings[i].samples, timings[j].samples);
}

TimingSession time_cases(const std::vector<CaseToTime>& all, const TimingOptions& options) {
  std::vector<SampledCase> cases = start_cases(all, options);
  Control control(all, options);
  const auto sample = [](SampledCase& one) {
    if (!one.worker) return;  // a control without any case
    one.guard([&] {
      const StepTime time = one.worker->sample(one.steps);
      one.timing.samples.push_back(time.cpu);
      one.timing.wall.push_back(time.wall);
    });
  };
  control.twin(cases);
  interleave(
      cases.size(), {options.rounds, options.deadline, options.progress},
      [&](std::size_t i) { sample(cases[i]); },
      [&] {
        SampledCase& twin = control.twin(cases);
        sample(twin);
        sample(twin);
      });
  TimingSession session;
  for (SampledCase& one : cases) {
    one.guard([&] {
      one.timing.peak_bytes = one.worker->peak_bytes();
      one.timing.remark = one.worker->remark();
    });
    session.timings.push_back(std::move(one.timing));
  }
  session.control = control.ratio(session.timings, &Timing::samples);
  session.wall_control = control.ratio(session.timings, &Timing::wall);
  return session;
}

}  // namespace taut
