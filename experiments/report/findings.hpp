#pragma once

#include <filesystem>
#include <optional>

#include "experiments/report/input.hpp"

namespace taut::report {

// What other verbs left in the results folder; nullopt if they did not or another build did. A
// file that cannot be understood is an InputError.

/// verify.json of `taut verify -o`. `program`: measurement() of this build.
std::optional<Truths> stored_truths(const std::filesystem::path& results, std::string_view program);

/// check.json of `taut check --record`.
std::optional<Regressions> stored_regressions(const std::filesystem::path& results,
                                              std::string_view program);

/// found.json of every scene that `taut require` was asked about, by name.
std::vector<RequiredModel> stored_requirements(const std::filesystem::path& results,
                                               std::string_view program);

/// What `taut frontier --all` found, solver by solver.
std::vector<ParameterFrontier> stored_frontiers(const std::filesystem::path& results,
                                                std::string_view program);

}  // namespace taut::report
