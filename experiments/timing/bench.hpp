#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/case/record.hpp"
#include "experiments/timing/candidate.hpp"
#include "experiments/timing/timing.hpp"

namespace taut {

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
  std::string scene;
  Interval control;  ///< the first case against itself: how far apart the same code strays here
  std::vector<BenchedCase> cases;

  /// The cases by their error in the metric's value; same order.
  std::vector<Candidate> candidates(const std::string& metric) const;
  /// Cost of case i over case j per simulated second, from their interleaved samples; nothing if
  /// either failed.
  std::optional<Interval> ratio(std::size_t i, std::size_t j) const;
  /// How far the cases of a solver go along its accuracy parameters.
  std::vector<ParameterRange> parameter_ranges(const std::string& solver) const;
  /// All of them to the end: only then is an error that no case reaches never reached.
  bool searched_to_the_end(const std::string& solver) const;
};

/// What `taut bench STUDY` leaves for reports and plots: every sample is kept.
struct BenchSession {
  std::string study;
  std::string machine;  ///< processor and number of cores
  std::vector<SceneBench> scenes;
  std::string host = {};   ///< name of the machine: times of two are never pooled
  std::string build = {};  ///< program_digest of the program that was timed

  /// Nothing measured yet; on this machine, by this program.
  static BenchSession here(const std::string& study);
  /// The records, each with its cost as further values: "cpu.per_second", "cpu.per_step",
  /// "wall.per_step" [s], "memory.peak" [bytes].
  std::vector<Record> records() const;
};

/// Times cases of one scene whose physics are known.
SceneBench bench_scene(const std::string& scene, const std::vector<Record>&, const BenchOptions&);

/// Names of the solvers in a bench, in order of appearance.
std::vector<std::string> solvers_of(const SceneBench&);

std::string to_json(const BenchSession&);
/// Throws InputError that names `where` if the text is not a bench of this schema.
BenchSession bench_from_json(std::string_view text, const std::string& where);

/// Where a session lies in a results folder: a file for each host and build.
std::filesystem::path bench_file(const std::filesystem::path& results, const BenchSession&);

/// Writes it there.
std::filesystem::path keep(const std::filesystem::path& results, const BenchSession&);

/// What is stored of a study: of this host and build, of this host, of others by name.
std::vector<std::filesystem::path> bench_files(const std::filesystem::path& results,
                                               const std::string& study);

/// Throws InputError in a Slurm job that may not time: on several nodes, or not alone on its node.
void require_one_quiet_host();

}  // namespace taut
