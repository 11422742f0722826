#pragma once

#include <span>
#include <string_view>

namespace taut {

enum class AssertionVerdict { holds, holds_if, does_not_hold, cannot_be_tested };
std::string_view to_string(AssertionVerdict);

/// An assertion of Vasilovici's Cloth Simulation Report that can be tested, and what became of it.
struct VasiloviciAssertion {
  std::string_view section;  ///< of the report
  std::string_view assertion;
  AssertionVerdict verdict;
  std::string_view because;      ///< the condition, the figure, or why it cannot be tested
  std::string_view truth;        ///< by name: `taut verify` holds the verdict to it; "": none can
  std::string_view figure = "";  ///< how the truth's number that is quoted begins; "": the first
};

/// All of them, in the report's order.
std::span<const VasiloviciAssertion> vasilovici_assertions();

}  // namespace taut
