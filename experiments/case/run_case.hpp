#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/model/pin_places.hpp"
#include "core/model/scene.hpp"
#include "core/model/solver.hpp"
#include "experiments/case/record.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

/// Values over time: columns "step", "t" and every metric value that is meaningful at a moment.
struct Series {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

/// Rows of the values over time that results and files of a case have: RunOptions::series_rows.
inline constexpr int kSeriesRows = 120;

/// CPU time of metrics, which is not the solver's.
struct MeasuringTime {
  /// s; once all metrics together have taken as long, the dearest of them has no value, and says
  /// so.
  double most = std::numeric_limits<double>::infinity();
  /// Gets the metric that is at work (null: none is) and the time [s] of all of them until now.
  std::function<void(const MetricEntry*, double)> tell = {};
};

struct RunOptions {
  int series_rows = 0;  ///< about this many rows, evenly spaced, first and last included; 0: none
  int every = 0;  ///< a row every so many steps instead, first and last included; 0: series_rows
  bool timed = false;   ///< note the cost of the steps: CaseRun::cpu_seconds
  bool measure = true;  ///< let all metrics() observe; without them `values` stays empty
  std::function<void(const Snapshot&)>
      watch;  ///< also sees every stable boundary, the start included
  MeasuringTime measuring = {};
};

/// What became of a case: the record and what is too big for it.
struct CaseRun {
  Record record;  ///< key and id are empty: run_case of a Case (case.hpp) sets them
  Series series;
  State last;  ///< the final state or, of a run that exploded, the state before; empty: nothing ran

  /// CPU seconds of all steps. Metrics ran in between, so this is a first impression and no sample
  /// (experiments/timing). NaN: not asked for, or it cannot be measured.
  double cpu_seconds = std::numeric_limits<double>::quiet_NaN();

  bool computed() const { return !last.x.empty(); }
};

/// Runs one case in this process, step by step: load, then for every step `step` and `store`, with
/// the detector of divergence and every metric at every boundary. A run that explodes ends there
/// with values NaN. So does one whose pins are not where the scene has them: `protocol`, or `error`
/// if the solver is part of this program. A scene that the solver cannot represent gives
/// `unsupported` and no run; a SolverFailure the status that it names and the last stable step.
/// Numerical failure never throws; what make() throws (InputError, bad_alloc) passes through.
CaseRun run_case(const Scene&, const SolverChoice&, const RunOptions& = {});

/// A pin that is not where the scene has it at time t [s]: "vertex 3 is 0.2 m from (0, 1, 0) at t =
/// 0.5 s".
std::string said(const PinPlaces::Stray&, double t);

/// What is known of a case before it runs.
Record describe(const Scene&, const SolverChoice&);
/// Sets what is known of the solver: its name, its parameters, substeps and sweeps.
void describe_solver(Record&, const SolverChoice&);

}  // namespace taut
