#pragma once

#include <filesystem>
#include <optional>

#include "experiments/report/input.hpp"

namespace taut::report {

// What other verbs left in the results folder; nullopt if they did not or another build did. A
// file that cannot be understood is an InputError.

/// verify.json of `taut verify -o`: of each truth the finding that is nearest to its tolerance,
/// and every finding that did not simply pass. `program`: measurement() of this build.
std::optional<Truths> stored_truths(const std::filesystem::path& results, std::string_view program);

/// check.json of `taut check --record`: how much was compared with the committed baselines, and
/// what moved.
std::optional<Json> stored_regressions(const std::filesystem::path& results,
                                       std::string_view program);

/// found.json of every scene that `taut require` was asked about, by name: the smallest model that
/// keeps its answers, a row each. Null: there is none.
Json stored_requirements(const std::filesystem::path& results, std::string_view program);

/// What `taut frontier --all` found, solver by solver.
std::vector<ParameterFrontier> stored_frontiers(const std::filesystem::path& results,
                                                std::string_view program);

}  // namespace taut::report
