#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/truths/assertions/assertions.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

/// An assertion of a publication with the present verdict of its truth.
struct JudgedAssertion {
  std::string source, section, assertion;
  AssertionVerdict verdict;
  /// Quoted from the truth: "jakobsen: RMS stretch 0.061 (0.06 +- 0.01)"; may be empty.
  std::string figure;
};

/// The findings of a truth by name; nullptr if it was not checked.
using FindingsOf = std::function<const std::vector<Finding>*(std::string_view truth)>;

/// Every assertion whose truth was checked, and those for which there is no truth.
std::vector<JudgedAssertion> judge_assertions(const FindingsOf&);

}  // namespace taut
