#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/limits.hpp"
#include "experiments/timing/judge.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

/// Largest values that a search for a setting tries.
inline constexpr int kMostSubsteps = 1024, kMostSweeps = 128;

/// The strain that is drawn over sweeps and over builds.
inline constexpr const char* kErrorMetric = "stretch.rms";
inline constexpr double kFrameBudgets[] = {0.1e-3, 0.5e-3, 1e-3, 4e-3, 16e-3};  ///< s per frame

/// Names of costs, as those of metrics' values: CPU time of all threads per simulated second and
/// per step, wall time per step, and the largest memory of the process.
inline constexpr const char *kCpuPerSecond = "cpu.per_second", *kCpuPerStep = "cpu.per_step",
                            *kWallPerStep = "wall.per_step", *kPeakMemory = "memory.peak";

/// A case with measured physics and cost.
struct BenchedCase {
  Record record;
  Timing timing;

  /// CPU seconds per simulated second, with its 95 % interval over the samples.
  Interval cost() const;
  /// Whether cost and errors count: no failure, no explosion, and at least one sample.
  bool stable() const;
  /// Why there is no cost; "" if there is.
  std::string not_timed() const;
};

/// The largest value of an accuracy parameter that was tried, and the last one that a search would
/// try.
struct ParameterRange {
  std::string parameter;
  int largest = 0, end = 0;
};

/// All settings of all solvers on one scene, timed in one interleaved session.
struct SceneBench {
  std::string scene;  ///< name that distinguishes it in the study (title_among())
  Interval control;   ///< the first case against itself: how far identical code deviates here
  std::vector<BenchedCase> cases;
  /// False: timed one after another, without control, so that no two can be compared.
  bool in_turns = true;
  /// Limits of the scene; nothing if they were not determined, so that no case can win anything.
  std::optional<std::vector<Limit>> limits = {};

  /// The cases in the same order, judged by this metric.
  std::vector<Candidate> candidates(const std::string& metric) const;
  /// The metric that decides here (taut::deciding_metric()).
  std::string deciding_metric() const;
  /// Cost per simulated second of case i relative to case j, from their interleaved samples.
  /// Nothing if either failed or they were not timed in turns.
  std::optional<Interval> ratio(std::size_t i, std::size_t j) const;
  /// Range of each accuracy parameter that the cases of a solver cover.
  std::vector<ParameterRange> parameter_ranges(const std::string& solver) const;
  /// Whether all ranges are covered to the end. Only then does an error that no case reaches count
  /// as unreachable.
  bool searched_to_the_end(const std::string& solver) const;
};

/// Measurements of `taut bench STUDY`, for reports and plots.
struct StudyBench {
  std::string study;
  std::string machine;  ///< processor and number of cores
  std::vector<SceneBench> scenes;
  std::string host = {};   ///< name of the machine; times of two machines are never pooled
  std::string build = {};  ///< program_digest of the timed program; not a Build of a history

  /// An empty bench of this machine and this program.
  static StudyBench here(const std::string& study);
  /// The records with costs as additional values: kCpuPerSecond, kCpuPerStep, kWallPerStep [s] and
  /// kPeakMemory [B].
  std::vector<Record> records() const;
};

/// Times these cases scene by scene, with the default limits of each scene. Other settings of a
/// scene make it another scene, except for the time step, since costs are per simulated second.
/// Calls `options_of` before each scene. Throws InputError if a scene cannot be made.
StudyBench bench_study(
    const std::string& name, const std::vector<Record>&,
    const std::function<TimingOptions(const std::string& scene, std::size_t cases)>& options_of);

/// Times the cases of one scene. Their records are known; `limits` says what is acceptable.
SceneBench bench_scene(const std::string& scene, const std::vector<Record>&,
                       const std::vector<Limit>& limits, const TimingOptions&);

/// Names of the solvers in a bench, in order of appearance.
std::vector<std::string> solvers_of(const SceneBench&);

/// Stores every sample in place of earlier measurements of this study by this host and build.
/// Throws InputError; the earlier ones then stay.
void keep(Store&, const StudyBench&);

/// The stored benches of a study ("": of all): first that of this host and build, then others of
/// this host, then those of other hosts by name. Leaves out cases that are not stored and scenes
/// without any.
std::vector<StudyBench> stored_benches(const Store&, const std::string& study);

/// Throws InputError in a Slurm job that spans several nodes or shares its node, where timing is
/// not valid.
void require_one_quiet_host();

}  // namespace taut
