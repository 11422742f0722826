#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "experiments/answer/answer.hpp"

namespace taut {

/// File in a folder of baselines that keeps the verdicts on assertions of publications.
std::filesystem::path assertion_baseline(const std::filesystem::path& folder);
/// Writes the table `assertions` of an answer of `taut verify` to that file.
void keep_assertions(const Answer&, const std::filesystem::path& file);
/// Verdicts that differ from the kept ones; nothing if none are kept. Figures may differ: the
/// tolerance of the truth judges them.
std::optional<std::vector<Difference>> changes_of_assertions(const Answer&,
                                                             const std::filesystem::path& file);

}  // namespace taut
