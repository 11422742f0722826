#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace taut {

enum class AssertionVerdict { holds, holds_if, does_not_hold, cannot_be_tested };
std::string_view to_string(AssertionVerdict);

/// What a publication asserts of a solver, and what became of it here.
struct Assertion {
  std::string_view source;     ///< "Macklin et al., Small Steps in Physics Simulation, SCA 2019"
  std::string_view place;      ///< where it says so, as far as its text was seen: "6.1", "Fig. 4"
  std::string_view assertion;  ///< with its numbers as printed
  AssertionVerdict verdict;
  std::string_view because;      ///< the condition, the figure, or why it cannot be tested
  std::string_view truth;        ///< by name: `taut verify` holds the verdict to it; "": none can
  std::string_view figure = "";  ///< the quantity of the truth that is quoted; "": the first
};

/// All of them, source by source.
const std::vector<Assertion>& assertions();

std::span<const Assertion> assertions_of_vasilovici();
std::span<const Assertion> assertions_of_papers();

}  // namespace taut
