#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/model/scene_setting.hpp"
#include "core/model/solver.hpp"
#include "core/model/status.hpp"

namespace taut {

/// What is to be run: names and settings, no content. Solver in canonical form
/// (SolverChoice::canonical()).
struct CaseSpec {
  std::string scene;  ///< name of a shipped scene, or a path
  SceneSettings settings;
  std::string solver;  ///< "jakobsen:iterations=8,..."
};

/// A case that was run: one line of every table. Everything that metrics, plots, reports and checks
/// need. How it is written and kept: record_columns().
struct Record {
  std::string key;      ///< case_key() (experiments/case/digest.hpp)
  std::string id;       ///< for people, unique in a study: "hang dt=1/64 jakobsen:iterations=8"
  std::string setting;  ///< the same without the scene
  CaseSpec spec;
  std::string scene;                          ///< its name
  std::string solver;                         ///< the entry's name
  std::map<std::string, std::string> params;  ///< all of the solver's
  /// Substeps of a step and sweeps of a substep, by the solver's AccuracyParameters; -1: it has no
  /// such parameter.
  int substeps = -1, sweeps = -1;
  std::vector<std::string> work_parameters;  ///< which of the parameters these are
  double dt = 0;                             ///< s
  int steps = 0;
  int vertices = 0, links = 0;
  Status status;
  std::map<std::string, double> values;  ///< by metric value name; NaN: no meaning here
  std::size_t projections = 0;           ///< per step
  std::vector<PassCost> step_cost;
  ResolvedSettings resolved_settings;
  std::string digest;  ///< SHA-256 of the final state's bits
  std::string log;  ///< the end of what a solver's own program wrote to standard error; no result

  /// One of the values; NaN: it is not there, or has no meaning here.
  double value(const std::string& name) const;
};

}  // namespace taut
