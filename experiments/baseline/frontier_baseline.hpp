#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/baseline/check.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"

namespace taut {

/// File in a folder of baselines that keeps the frontiers of a solver ("jakobsen:iterations=8").
std::filesystem::path frontier_baseline(const std::filesystem::path& folder,
                                        const std::string& solver);
/// Writes an answer of `taut frontier --all SOLVER` to that file.
void keep_frontiers(const Answer&, const std::filesystem::path& file);
/// Result of keeping or comparing frontiers: `news` says what was done, `changes` lists
/// differences.
struct FrontierCheck {
  CheckEnd end = CheckEnd::passed;
  std::string news;
  std::vector<Difference> changes;
};
FrontierCheck check_frontiers(const Answer&, const std::string& solver,
                              const std::filesystem::path& folder, bool update);
/// Differences between an answer and the kept one; nothing if none is kept.
std::optional<std::vector<Difference>> changes_of_frontiers(const Answer&,
                                                            const std::filesystem::path& file);

/// The commands that run the cases just beyond the frontiers.
Table commands_of(const std::vector<ParameterFrontier>&);

}  // namespace taut
