#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "experiments/answer/answer.hpp"

namespace taut {

/// Where a folder of baselines keeps the verdicts of assertions of publications.
std::filesystem::path assertion_baseline(const std::filesystem::path& folder);
/// Keeps the table `assertions` of an answer of `taut verify` there.
void keep_assertions(const Answer&, const std::filesystem::path& file);
/// Verdicts that differ from those kept; nothing: none are kept. Figures may differ: the truth's
/// tolerance judges them.
std::optional<std::vector<Difference>> changes_of_assertions(const Answer&,
                                                             const std::filesystem::path& file);

}  // namespace taut
