#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "experiments/case/comparison.hpp"
#include "experiments/results/builds.hpp"

namespace taut {

class Store;

/// What a build found of a case. Builds whose results are the same to the bit have one together.
struct HistoryPoint {
  std::string key;         ///< of a case that is stored with it
  std::string status;      ///< "ok", "exploded (energy)"
  bool completed = false;  ///< its values may be compared
  MetricValues values;
};

/// A case of a study, build by build.
struct HistoryRow {
  std::string id;             ///< "hang jakobsen:iterations=8"
  std::string scene, solver;  ///< names
  /// By build; nullptr: it has no result of this case.
  std::vector<std::shared_ptr<const HistoryPoint>> points;
  std::vector<std::string> keys;  ///< by build; "": the build did not plan it
};

/// A value that is not what it was in the build before, beyond what is noise.
struct HistoryStep {
  std::size_t row = 0;
  std::size_t before = 0, now = 0;  ///< builds; those between them have no result of the case
  std::string value;                ///< "stretch.rms", "status", "cpu.per_step", "wall.per_step"
  double was = 0, is = 0;           ///< SI; of a cost 1 and the ratio
  std::string text;                 ///< of a status: "ok to exploded (energy)"
  double relative = 0;              ///< relative_change()
  bool of_time() const { return value.ends_with(".per_step"); }
};

struct History {
  std::string study;
  std::vector<Build> builds;
  std::vector<HistoryRow> rows;    ///< by id
  std::vector<BuildRatio> ratios;  ///< of pairs of these builds
  std::vector<HistoryStep> steps;  ///< the largest first
  std::size_t compared = 0;        ///< pairs of neighbouring results, costs included

  bool is_gap(std::size_t build) const { return !builds[build].gap.empty(); }
  /// Cases that the build planned and has no result of; of the last one also those that the one
  /// before planned and it did not.
  std::size_t missing(std::size_t build) const;
  /// How many cases of a build have the address that the build before has for them.
  std::size_t shared(std::size_t build) const;
  /// Whether the last build that has a result differs from what was before it.
  bool last_stepped() const;
};

/// What is stored of a study, of these builds in this order; without any: of all builds in their
/// own. Values step beyond `tolerances`, costs beyond interval and control of two builds that were
/// timed in turns. What does not match its digest is reported, and no step rests on it. Throws
/// InputError: the file is damaged.
History history_of(const Store&, const std::string& study, const Tolerances&,
                   const std::vector<Build>& builds = {});

/// A cost of a build over another one's that is a difference beyond noise: CPU time, else wall
/// time. nullptr: there is none.
const BuildRatio* cost_step(const std::vector<BuildRatio>&, const std::string& id,
                            const std::string& before, const std::string& now);

}  // namespace taut
