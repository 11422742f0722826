#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/baseline/check.hpp"
#include "experiments/study/frontier/parameter_frontier.hpp"

namespace taut {

/// Where a folder of baselines keeps the frontiers of a solver ("jakobsen:iterations=8").
std::filesystem::path frontier_baseline(const std::filesystem::path& folder,
                                        const std::string& solver);
/// Keeps an answer of `taut frontier --all SOLVER` there.
void keep_frontiers(const Answer&, const std::filesystem::path& file);
/// Keeps it, or compares it with what is kept: what became of it in `news`, what differs in
/// `changes`.
struct FrontierCheck {
  CheckEnd end = CheckEnd::passed;
  std::string news;
  std::vector<Difference> changes;
};
FrontierCheck check_frontiers(const Answer&, const std::string& solver,
                              const std::filesystem::path& folder, bool update);
/// How an answer differs from the one kept; nothing: none is kept.
std::optional<std::vector<Difference>> changes_of_frontiers(const Answer&,
                                                            const std::filesystem::path& file);

/// The commands that run the cases beyond.
Table commands_of(const std::vector<ParameterFrontier>&);

}  // namespace taut
