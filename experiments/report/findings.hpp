#pragma once

#include <optional>

#include "experiments/report/input.hpp"
#include "experiments/results/store.hpp"

namespace taut::report {

// What `program` (program_digest) found of other questions, as the results file has it. An answer
// that cannot be understood is an InputError.

/// Of `taut verify --record`: of each truth the finding that is nearest to its tolerance, and every
/// finding that did not simply pass; nullopt: not asked.
std::optional<Truths> stored_truths(const Store&, std::string_view program);

/// Of `taut check --record`: how much was compared with the committed baselines, and what moved;
/// nullopt: not asked.
std::optional<Json> stored_regressions(const Store&, std::string_view program);

/// Of every scene that `taut require` was asked about, by name: the smallest model that keeps its
/// answers, a row each. Null: there is none.
Json stored_requirements(const Store&, std::string_view program);

/// Of `taut frontier --all`, solver by solver.
std::vector<ParameterFrontier> stored_frontiers(const Store&, std::string_view program);
/// Of `taut converge`, scene by scene.
std::vector<OneStep> stored_steps(const Store&, std::string_view program);

}  // namespace taut::report
