#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/results/store.hpp"
#include "experiments/study/limits.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

/// One setting of one solver on one scene: what it costs and how far it is off.
struct Candidate {
  enum class Refusal {
    failed,        ///< it did not run to its end, or could not be timed
    hardly_moves,  ///< its strain is that of cloth that stands still
    not_accepted   ///< it does what its scene does not accept
  };
  std::string solver;   ///< the entry's name
  std::string setting;  ///< "jakobsen:substeps=16,iterations=1"
  Interval cost;        ///< CPU seconds per simulated second
  double error = 0;     ///< of the chosen metric, >= 0; NaN if the metric has no meaning here
  std::string failure;  ///< why it is refused, such as "exploded (energy)"; empty: it is not
  Refusal refusal = Refusal::failed;  ///< which kind of failure that is

  /// Whether it has a cost and an error that do not count.
  bool is_uncounted() const { return !failure.empty() && refusal != Refusal::failed; }
};

/// What is asked for: the cheapest setting within an error, or the most accurate within a cost.
/// Exactly one is set.
struct Target {
  std::optional<double> error;   ///< of the metric, its SI unit
  std::optional<double> budget;  ///< CPU seconds per simulated second

  /// A failure meets nothing.
  bool meets(const Candidate&) const;
  /// Whether a serves the target better than b; one that meets it beats all that do not.
  bool prefers(const Candidate& a, const Candidate& b) const;
};

/// The candidate of `solver` ("" = any) that serves the target best; nothing: none meets it.
std::optional<std::size_t> best_for(const Target&, std::span<const Candidate>,
                                    const std::string& solver = "");

/// Where a search for a setting ends.
inline constexpr int kMostSubsteps = 1024, kMostSweeps = 128;

/// The errors and budgets for which a bench answers, and the metric value that is the error unless
/// another one is asked for.
inline constexpr const char* kErrorMetric = "stretch.rms";
inline constexpr double kErrorLevels[] = {0.1, 0.03, 0.01, 0.003, 0.001};
inline constexpr double kFrame = 1.0 / 60;  ///< s; budgets are CPU time within it
/// How people see CPU seconds per simulated second: as ms of a frame, `fps` frames a second.
constexpr Unit frame_cost(double fps) { return {"s/s", "ms a frame", 1e3 / fps}; }
inline constexpr Unit kFrameCost = frame_cost(1 / kFrame);
inline constexpr double kFrameBudgets[] = {0.1e-3, 0.5e-3, 1e-3, 4e-3, 16e-3};  ///< s per frame

/// A case whose physics and whose cost were both measured.
struct BenchedCase {
  Record record;
  Timing timing;

  /// CPU seconds per simulated second, with its 95 % interval over the samples.
  Interval cost() const;
  /// Whether cost and errors count: no failure, no explosion, at least one sample.
  bool stable() const;
};

/// The largest value tried of an accuracy parameter, and the last one that a search would try.
struct ParameterRange {
  std::string parameter;
  int largest = 0, end = 0;
};

/// All settings of all solvers on one scene, timed in one interleaved session.
struct SceneBench {
  std::string scene;  ///< its title (title_among())
  Interval control;   ///< the first case against itself: how far apart the same code strays here
  std::vector<BenchedCase> cases;
  bool in_turns = true;  ///< false: one after the other, without control; no two can be compared
  /// What its scene accepts; nothing: nobody asked the scene, so that no case can win anything.
  std::optional<std::vector<Limit>> limits = {};

  /// The cases by their error in the metric's value; same order. Those beyond the limits are not
  /// accepted.
  std::vector<Candidate> candidates(const std::string& metric) const;
  /// Cost of case i over case j per simulated second, from their interleaved samples; nothing if
  /// either failed, or if they were not timed in turns.
  std::optional<Interval> ratio(std::size_t i, std::size_t j) const;
  /// How far the cases of a solver go along its accuracy parameters.
  std::vector<ParameterRange> parameter_ranges(const std::string& solver) const;
  /// All of them to the end: only then is an error that no case reaches never reached.
  bool searched_to_the_end(const std::string& solver) const;
};

/// What `taut bench STUDY` measures, for reports and plots.
struct StudyBench {
  std::string study;
  std::string machine;  ///< processor and number of cores
  std::vector<SceneBench> scenes;
  std::string host = {};   ///< name of the machine: times of two are never pooled
  std::string build = {};  ///< program_digest of the program that was timed

  /// Nothing measured yet; on this machine, by this program.
  static StudyBench here(const std::string& study);
  /// The records, each with its cost as further values: "cpu.per_second", "cpu.per_step",
  /// "wall.per_step" [s], "memory.peak" [bytes].
  std::vector<Record> records() const;
};

/// Times these cases scene by scene, within the default limits of each. Other settings of a scene
/// make another scene, except the time step: costs are those of a simulated second. Calls
/// `options_of` before each scene. Throws InputError: a scene cannot be made.
StudyBench bench_study(
    const std::string& name, const std::vector<Record>&,
    const std::function<TimingOptions(const std::string& scene, std::size_t cases)>& options_of);

/// Times cases of one scene whose physics are known. The limits: what is accepted of them.
SceneBench bench_scene(const std::string& scene, const std::vector<Record>&,
                       const std::vector<Limit>& limits, const TimingOptions&);

/// Names of the solvers in a bench, in order of appearance.
std::vector<std::string> solvers_of(const SceneBench&);

/// Keeps every sample in place of what this host and build measured of the study before. Throws
/// InputError; then the former stay.
void keep(Store&, const StudyBench&);

/// The stored benches of a study ("": of all): first that of this host and build, then those of
/// this host, then of others by name. Without cases that are not stored, and scenes that have none.
std::vector<StudyBench> stored_benches(const Store&, const std::string& study);

/// Throws InputError in a Slurm job that may not time: on several nodes, or not alone on its node.
void require_one_quiet_host();

}  // namespace taut
