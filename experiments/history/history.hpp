#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/status.hpp"
#include "experiments/case/comparison.hpp"
#include "experiments/results/builds.hpp"

namespace taut {

class Store;

/// Result of a build for a case. Builds whose results agree to the bit share one point.
struct HistoryPoint {
  std::string key;      ///< key of a stored case with this result
  Status status;        ///< without step and vertex
  MetricValues values;  ///< none unless it completed(), since others are not compared
};
/// Whether two results ended in the same way: status and reason.
bool ended_alike(const HistoryPoint&, const HistoryPoint&);

/// What may change between builds: how a case ends, a value, or the cost of a step.
struct Changing {
  enum class Kind { value, status, cpu, wall };
  Kind kind = Kind::value;
  std::string metric = {};  ///< name of the value, "stretch.rms"; "" for other kinds

  bool is_cost() const { return kind == Kind::cpu || kind == Kind::wall; }
  /// Its name in tables and in `--bisect`: "stretch.rms", "status", "cpu.per_step",
  /// "wall.per_step".
  std::string name() const;
  auto operator<=>(const Changing&) const = default;
};
/// Inverse of Changing::name(); any other name counts as that of a value.
Changing changing(std::string_view name);

/// A case of a study, across builds.
struct HistoryRow {
  std::string id;             ///< "hang jakobsen:iterations=8"
  std::string scene, solver;  ///< their names
  /// Results by build; nullptr: the build has no result for this case.
  std::vector<std::shared_ptr<const HistoryPoint>> points;
  std::vector<std::string> keys;  ///< by build; "": the build did not plan this case
};

/// A value that differs from the previous build's by more than tolerance or noise.
struct HistoryStep {
  std::size_t row = 0;
  /// Indices of builds; builds between them have no result for the case.
  std::size_t before = 0, now = 0;
  Changing what;
  double was = 0, is = 0;  ///< SI; for a cost, 1 and the ratio; 0 for a status
  double relative = 0;     ///< relative_change(); infinite for a status
};

struct History {
  std::string study;
  std::vector<Build> builds;
  std::vector<HistoryRow> rows;    ///< sorted by id
  std::vector<BuildRatio> ratios;  ///< cost ratios of pairs of these builds
  std::vector<HistoryStep> steps;  ///< largest first
  std::size_t compared = 0;        ///< pairs of neighbouring results, including costs

  bool is_gap(std::size_t build) const { return !builds[build].gap.empty(); }
  /// Number of cases that the build planned but has no result for. For the last build this includes
  /// cases that only the previous build planned.
  std::size_t missing(std::size_t build) const;
  /// Number of cases to which this build and the previous one give the same key.
  std::size_t shared(std::size_t build) const;
  /// Whether the last build with a result differs from the one before.
  bool last_stepped() const;
};

/// The stored history of a study over these builds, in this order; if none are given, over all
/// builds in the order of the store. A value steps if it moves beyond `tolerances`, a cost if it
/// moves beyond interval and control of two builds that were timed in turns. Results that do not
/// match their digest are reported, and cause no step. Throws InputError if the file is damaged.
History history_of(const Store&, const std::string& study, const Tolerances&,
                   const std::vector<Build>& builds = {});

/// The ratio between the costs of two builds, if it differs beyond noise: of CPU time, or else of
/// wall time. nullptr if neither does.
const BuildRatio* cost_step(const std::vector<BuildRatio>&, const std::string& id,
                            const std::string& before, const std::string& now);

}  // namespace taut
