#pragma once

#include <optional>

#include "experiments/report/input.hpp"
#include "experiments/results/store.hpp"

namespace taut::report {

// Answers of other verbs that `program` (program_digest) stored in the results file. Throw
// InputError if an answer cannot be understood.

/// Answer of `taut verify --record`: for each truth the finding nearest to its tolerance, and all
/// findings that did not simply pass. nullopt if there is no answer.
std::optional<Truths> stored_truths(const Store&, std::string_view program);

/// Answer of `taut check --record`: how much was compared with the committed baselines, and what
/// moved. nullopt if there is no answer.
std::optional<Json> stored_regressions(const Store&, std::string_view program);

/// Answers of `taut require`, by name of the scene: a row for the smallest model that keeps the
/// scene's answers. Null if there is no answer.
Json stored_requirements(const Store&, std::string_view program);

/// Answers of `taut frontier --all`, solver by solver.
std::vector<ParameterFrontier> stored_frontiers(const Store&, std::string_view program);
/// Answers of `taut converge`, scene by scene.
std::vector<OneStep> stored_steps(const Store&, std::string_view program);

}  // namespace taut::report
