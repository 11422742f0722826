#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/model/solver.hpp"

namespace taut {

using Lines = std::vector<std::pair<std::string, std::string>>;  ///< name and value of a setting

/// Settings that a solver reports for its parameters on a scene.
inline Lines settings(const Scene& scene, const std::string& solver) {
  const SolverChoice choice = parse_solver(solver);
  Lines lines;
  for (const ResolvedSetting& one : choice.entry->resolved_settings(scene, choice.params))
    lines.emplace_back(one.name, one.text);
  return lines;
}

/// All solvers except Bullet's, in double where they have a choice.
inline std::vector<std::string> our_solvers() {
  std::vector<std::string> all;
  for (const SolverEntry* entry : solvers()) {
    if (entry->name.starts_with("bullet")) continue;
    const auto is_precision = [](const ParamSpec& p) { return p.name == "precision"; };
    const bool chooses = std::ranges::any_of(entry->params, is_precision);
    all.push_back(std::string(entry->name) + (chooses ? ":precision=double" : ""));
  }
  EXPECT_GE(all.size(), 8u);
  return all;
}

/// Reasons for which a solver refuses a scene; empty if it accepts it.
inline std::vector<std::string> refused(const Scene& scene, const std::string& solver) {
  const SolverChoice choice = parse_solver(solver);
  return choice.entry->unsupported(scene, choice.params);
}

}  // namespace taut
