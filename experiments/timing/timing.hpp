#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/model/solver.hpp"
#include "experiments/case/record.hpp"
#include "experiments/system/process.hpp"
#include "experiments/timing/statistics.hpp"

namespace taut {

/// Time of a step in a sample, by the solver's CPU clock (Solver::cpu_seconds) and by the wall
/// clock. Both run only during Solver::step.
struct StepTime {
  double cpu = 0;   ///< s, sum of all threads
  double wall = 0;  ///< s; exceeds cpu / threads on a busy machine, so it is only for display
};

/// A computed run with up to four stored states, from which samples start. The first steps alone
/// would miss contacts, which come later. The states are evenly spaced, at least eight steps apart.
class CheckpointedRun {
 public:
  /// Runs the first `steps` steps.
  CheckpointedRun(const Scene&, Solver&, int steps);
  const StepTime& whole() const { return whole_; }
  /// Mean time per step over `steps` steps, with at least one from each state. Each start is
  /// preceded by an untimed step that warms the caches.
  StepTime sample(Solver&, int steps) const;

 private:
  struct Start {
    int step;
    State state;
  };
  double dt_;
  int length_;  ///< steps between two starts; the steps of one start never reach the next
  std::vector<Start> starts_;
  StepTime whole_;
};

/// Thrown if a worker does not answer before its deadline.
struct TimeIsUp : std::runtime_error {
  TimeIsUp() : std::runtime_error("time is up") {}
};

/// Samples one case in a process of its own that stays alive between samples.
class TimingWorker {
 public:
  /// Starts `bench --worker` of the program (by default program_of()) for the case. Throws
  /// InputError if the case cannot be built.
  explicit TimingWorker(const CaseSpec&, const std::filesystem::path& program = {});

  /// Runs the first `steps` steps once and returns their mean time. Required before sample(). Both
  /// functions throw std::runtime_error if the worker died.
  StepTime pilot_run(int steps);
  StepTime sample(int steps);  ///< see CheckpointedRun::sample
  /// From the deadline on, unanswered requests throw TimeIsUp.
  void give_up_at(std::chrono::steady_clock::time_point deadline) { deadline_ = deadline; }
  std::size_t peak_bytes();  ///< Solver::peak_bytes so far
  std::string remark();      ///< Solver::time_remark

 private:
  std::string ask(const std::string& line);
  StepTime ask_time(const std::string& line);
  Process process_;
  std::optional<std::chrono::steady_clock::time_point> deadline_;
};

/// The worker's side: reads requests from stdin and answers on stdout until the input ends. In a
/// Slurm job it binds itself to as many cores as the solver has threads (bind_to_cores()).
int serve_timing(const Scene&, const SolverChoice&);

/// Binds this process to the last `cores` of its allowed cores, so that samples do not move between
/// cores. Does nothing if fewer are allowed.
void bind_to_cores(int cores);

/// How many runs that take `each` [s] fit into `seconds`; at least 1, at most `most`.
int times_within(double seconds, double each, int most);

/// The program that can time the case: this one, or its sibling with the other build of Bullet.
std::filesystem::path program_of(const CaseSpec&);

/// Number of steps whose cost counts: all, or those before an explosion.
int steps_done(const Record&);

/// "Intel ... 2.80GHz, 2 cores".
std::string machine_name();

/// Measurements of one case.
struct Timing {
  std::vector<double> samples;    ///< CPU seconds per step, in the order taken: two per round
  std::vector<double> wall = {};  ///< the same samples in wall time
  std::size_t peak_bytes = 0;
  std::string failure;      ///< why it could not be timed; empty if it was
  std::string remark = {};  ///< why its time is doubtful; empty if it is not
};

/// A case to time, and the number of its steps (or of those it survived).
struct CaseToTime {
  CaseSpec spec;
  int steps = 0;
  std::filesystem::path program = {};  ///< program that times it; empty: program_of() the case
};

/// A session that samples all cases in rounds of alternating order (ABBA: A B C C B A), so that a
/// drift in the machine's speed cancels between any two of them. The first case that can be timed
/// runs twice, as its own A/A control.
struct TimingSession {
  std::vector<Timing> timings;
  Interval control;            ///< ratio of a case to itself; NaN if none could be timed
  Interval wall_control = {};  ///< the same ratio in wall time

  /// Cost of case i relative to case j, from their interleaved samples.
  Interval ratio(std::size_t i, std::size_t j) const;
};

struct TimingOptions {
  int rounds = 5;  ///< each gives two samples of every case
  /// CPU time of one sample [s]. A sample has as many steps as fit, at most all, spread over the
  /// whole run.
  double seconds = 0.05;
  std::function<void(std::size_t done, std::size_t all)> progress;
  /// Rounds that would not end by then are not started; a case that is not ready by then fails.
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
};
TimingSession time_cases(const std::vector<CaseToTime>&, const TimingOptions&);

}  // namespace taut
