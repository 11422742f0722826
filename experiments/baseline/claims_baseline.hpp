#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "experiments/truths/truth.hpp"
#include "experiments/truths/vasilovici/claims.hpp"

namespace taut {

/// A claim of Vasilovici's report with the verdict that its truth gives now.
struct JudgedClaim {
  std::string section, claim;
  std::string verdict;  ///< to_string(ClaimVerdict), or "overturned": its truth is broken
  std::string figure;  ///< of the truth: "jakobsen: RMS stretch 0.061 (0.06 +- 0.01)"; may be empty
  bool operator==(const JudgedClaim&) const = default;
};

/// The findings of a truth by name; nullptr: it was not checked.
using FindingsOf = std::function<const std::vector<Finding>*(std::string_view truth)>;

/// Every claim whose truth was checked, and those that no truth can hold.
std::vector<JudgedClaim> judge_claims(const FindingsOf&);

/// JSON lines. Reading throws InputError with file and line.
std::string to_json_lines(const std::vector<JudgedClaim>&);
std::vector<JudgedClaim> read_claims(const std::filesystem::path&);

/// A sentence for each claim that has another verdict than before, that is new or that is gone.
/// Figures may differ: the truth's tolerance judges them.
std::vector<std::string> compare_claims(const std::vector<JudgedClaim>& before,
                                        const std::vector<JudgedClaim>& now);

}  // namespace taut
