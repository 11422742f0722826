#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/model/solver.hpp"

namespace taut {

using Lines = std::vector<std::pair<std::string, std::string>>;  ///< name and value of a setting

/// What a solver makes of its parameters on a scene.
inline Lines settings(const Scene& scene, const std::string& solver) {
  const SolverChoice choice = parse_solver(solver);
  Lines lines;
  for (const ResolvedSetting& one : choice.entry->resolved_settings(scene, choice.params))
    lines.emplace_back(one.name, one.text);
  return lines;
}

/// Why a solver cannot run a scene; empty: it can.
inline std::vector<std::string> refused(const Scene& scene, const std::string& solver) {
  const SolverChoice choice = parse_solver(solver);
  return choice.entry->unsupported(scene, choice.params);
}

}  // namespace taut
