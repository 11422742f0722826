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

/// The time of a step in one sample, by the solver's CPU clock (Solver::cpu_seconds) and by the
/// wall clock: both run during Solver::step alone.
struct StepTime {
  double cpu = 0;   ///< s, of all threads together
  double wall = 0;  ///< s; longer than cpu / threads on a busy machine, so only for display
};

/// A computed run with up to four stored states, from which samples start: the first steps alone
/// would miss the contacts, which come later. The states are evenly spaced, at least eight steps
/// apart.
class CheckpointedRun {
 public:
  /// Runs the first `steps` steps.
  CheckpointedRun(const Scene&, Solver&, int steps);
  const StepTime& whole() const { return whole_; }
  /// Mean time of a step over `steps` steps, at least one from each state. Each start first takes
  /// one untimed step to warm the caches.
  StepTime sample(Solver&, int steps) const;

 private:
  struct Start {
    int step;
    State state;
  };
  double dt_;
  int length_;  ///< steps between two starts: a share never runs into the next
  std::vector<Start> starts_;
  StepTime whole_;
};

/// A worker did not answer before its deadline.
struct TimeIsUp : std::runtime_error {
  TimeIsUp() : std::runtime_error("time is up") {}
};

/// Samples of one case, taken in a process of its own that stays alive between them.
class TimingWorker {
 public:
  /// Starts `bench --worker` of the program, by default program_of(), for the case; throws
  /// InputError if the case cannot be built.
  explicit TimingWorker(const CaseSpec&, const std::filesystem::path& program = {});

  /// Runs the first `steps` steps once and returns their mean; required before sample(). Both throw
  /// std::runtime_error if the worker died.
  StepTime pilot_run(int steps);
  StepTime sample(int steps);  ///< see CheckpointedRun::sample
  /// After that, a request that is not answered throws TimeIsUp.
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
/// Slurm job on as many cores as the solver has threads (bind_to_cores()).
int serve_timing(const Scene&, const SolverChoice&);

/// Binds this process to the last `cores` of its allowed cores, so that no sample moves to others.
/// Does nothing if fewer are allowed.
void bind_to_cores(int cores);

/// Number of runs of `each` [s] that fit into `seconds`; 1 to `most`.
int times_within(double seconds, double each, int most);

/// The program that can time the case: this one, or its sibling with the other build of Bullet.
std::filesystem::path program_of(const CaseSpec&);

/// Steps whose cost counts: all, or those before an explosion.
int steps_done(const Record&);

/// "Intel ... 2.80GHz, 2 cores".
std::string machine_name();

/// What was measured of one case.
struct Timing {
  std::vector<double> samples;    ///< CPU seconds per step, in the order taken: two per round
  std::vector<double> wall = {};  ///< the same in wall time
  std::size_t peak_bytes = 0;
  std::string failure;      ///< why it could not be timed; empty: it was
  std::string remark = {};  ///< why its time is doubtful; empty: it is not
};

/// A case to be timed, and how many steps it has (or survived).
struct CaseToTime {
  CaseSpec spec;
  int steps = 0;
  std::filesystem::path program = {};  ///< that times it; empty: program_of() the case
};

/// Every case sampled in rounds of alternating order (ABBA: A B C C B A), so that a
/// drift of the machine's speed cancels between any two of them; the first case that can be timed
/// runs twice as its own A/A control.
struct TimingSession {
  std::vector<Timing> timings;
  Interval control;            ///< ratio of a case to itself; not a number: none could be timed
  Interval wall_control = {};  ///< the same in wall time

  /// Cost of case i over case j, from their interleaved samples.
  Interval ratio(std::size_t i, std::size_t j) const;
};

struct TimingOptions {
  int rounds = 5;         ///< each gives two samples of every case
  double seconds = 0.05;  ///< CPU time of one sample: as many steps as fit, at most all;
                          ///< they are spread over the whole run
  std::function<void(std::size_t done, std::size_t all)> progress;
  /// No round begins that would not end by then; a case that is not ready by then has a failure.
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
};
TimingSession time_cases(const std::vector<CaseToTime>&, const TimingOptions&);

}  // namespace taut
