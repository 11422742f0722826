#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/model/solver.hpp"
#include "experiments/lab/record.hpp"
#include "experiments/lab/statistics.hpp"

namespace taut {

/// CPU seconds per step that `solver` needs for the first `steps` steps of the scene, as this
/// process's CPU clock counts them: only Solver::step is inside the clock. One untimed step comes
/// first (caches, first touch). With several threads it is the CPU time of all of them.
double time_steps(const Scene&, Solver&, int steps);

/// Samples of one case, taken in a process of its own that stays alive between them.
class TimingWorker {
 public:
  /// Starts `program --worker` for the case; throws InputError if the case cannot be built.
  TimingWorker(const std::filesystem::path& program, const CaseSpec&);
  ~TimingWorker();
  TimingWorker(const TimingWorker&) = delete;
  TimingWorker& operator=(const TimingWorker&) = delete;

  /// CPU seconds per step over the first `steps` steps. Throws std::runtime_error if the worker
  /// died.
  double sample(int steps);
  std::size_t peak_bytes();  ///< resident set of the worker so far

 private:
  std::string ask(const std::string& line);
  int pid_ = -1;
  int to_ = -1;
  int from_ = -1;
};

/// The worker's side: reads requests from stdin and answers on stdout until the input ends.
int serve_timing(const Scene&, const SolverChoice&);

/// What was measured of one case.
struct Timing {
  CaseSpec spec;
  std::vector<double> samples;  ///< CPU seconds per step, in the order taken: two per round
  std::size_t peak_bytes = 0;
  std::string failure;  ///< why it could not be timed; empty: it was
};

/// One session: every case sampled in rounds that run forth and back (A B C C B A), so that a drift
/// of the machine's speed cancels between any two of them; the first case runs twice as its own A/A
/// control.
struct Bench {
  std::vector<Timing> timings;
  Interval control;  ///< ratio of the first case to itself

  /// Cost of case i over case j, from their interleaved samples.
  Interval ratio(std::size_t i, std::size_t j) const;
};

struct BenchOptions {
  int rounds = 5;         ///< each gives two samples of every case
  double seconds = 0.05;  ///< CPU time of one sample: as many steps as fit, all the steps at most
  std::function<std::filesystem::path(const CaseSpec&)>
      program;                                ///< which executable times the case
  std::function<int(const CaseSpec&)> steps;  ///< how many steps the case has (or survived)
  std::function<void(std::size_t done, std::size_t all)> progress;
};
Bench run_bench(const std::vector<CaseSpec>&, const BenchOptions&);

}  // namespace taut
