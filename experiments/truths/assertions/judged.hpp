#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/truths/assertions/assertions.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

/// An assertion of a publication with the verdict that its truth has now.
struct JudgedAssertion {
  std::string source, section, assertion;
  std::string verdict;  ///< to_string(AssertionVerdict), or "overturned": its truth is broken
  std::string figure;  ///< of the truth: "jakobsen: RMS stretch 0.061 (0.06 +- 0.01)"; may be empty
};

/// The findings of a truth by name; nullptr: it was not checked.
using FindingsOf = std::function<const std::vector<Finding>*(std::string_view truth)>;

/// Every assertion whose truth was checked, and those that no truth can hold.
std::vector<JudgedAssertion> judge_assertions(const FindingsOf&);

}  // namespace taut
