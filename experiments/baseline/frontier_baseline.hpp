#pragma once

#include <filesystem>
#include <vector>

#include "experiments/baseline/baseline.hpp"
#include "experiments/study/frontier/frontier.hpp"

namespace taut {

/// Which frontiers belong to a study's baseline: frontiers.toml of its folder, tables [[frontier]]
/// with scene, solver, of, from, to, tolerance and set (scene overrides). No file: none. Throws
/// InputError with file and line.
std::vector<FrontierQuestion> read_frontiers(const std::filesystem::path& folder);

/// What was found as a row: its status is the kind of frontier, its values are the ends of the
/// bracket and the number of stable values above it.
BaselineRow frontier_row(const FrontierQuestion&, const CaseFrontier&);

/// Id of the row of a question.
std::string frontier_id(const FrontierQuestion&);

}  // namespace taut
