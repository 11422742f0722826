#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "experiments/answer/answer.hpp"

namespace taut {

enum class AssertionVerdict {
  holds,
  holds_if,
  does_not_hold,
  cannot_be_tested,
  overturned  ///< its truth is broken; never the verdict of an Assertion
};
std::string_view to_string(AssertionVerdict);
Cell cell_of(AssertionVerdict);
/// Inverse of to_string(); `overturned` for any other text.
AssertionVerdict assertion_verdict_of(std::string_view);

/// An assertion of a publication about a solver, and its verdict here.
struct Assertion {
  std::string_view source;  ///< "Macklin et al., Small Steps in Physics Simulation, SCA 2019"
  /// Place in the publication, as far as its text was available: "6.1", "Fig. 4".
  std::string_view place;
  std::string_view assertion;  ///< the assertion, with its numbers as printed
  AssertionVerdict verdict;
  std::string_view because;  ///< condition, figure, or why it cannot be tested
  /// Name of the truth to which `taut verify` holds the verdict; "": none can.
  std::string_view truth;
  /// Quantity of the truth to quote, a constant of experiments/truths/quoted.hpp; "": the first.
  std::string_view figure = "";
  /// The solver whose number is quoted, where a truth measures the same of several; "": the first.
  std::string_view solver = "";
};

/// All assertions, source by source.
const std::vector<Assertion>& assertions();

std::span<const Assertion> assertions_of_vasilovici();
std::span<const Assertion> assertions_of_papers();

}  // namespace taut
