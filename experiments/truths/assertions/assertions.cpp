#include "experiments/truths/assertions/assertions.hpp"

#include "core/model/names.hpp"

namespace taut {

namespace {
constexpr Names<AssertionVerdict::overturned> kAssertionVerdicts{
    "holds", "holds under conditions", "does not hold", "cannot be tested", "overturned"};
}

std::string_view to_string(AssertionVerdict verdict) { return kAssertionVerdicts[verdict]; }

AssertionVerdict assertion_verdict_of(std::string_view text) {
  return kAssertionVerdicts.find(text).value_or(AssertionVerdict::overturned);
}

Cell cell_of(AssertionVerdict verdict) {
  const Cell word(to_string(verdict));
  switch (verdict) {
    case AssertionVerdict::holds:
      return word.toned(Cell::Tone::good);
    case AssertionVerdict::does_not_hold:
      return word.toned(Cell::Tone::doubtful);
    case AssertionVerdict::overturned:
      return word.toned(Cell::Tone::bad);
    case AssertionVerdict::holds_if:
    case AssertionVerdict::cannot_be_tested:
      break;
  }
  return word;
}

const std::vector<Assertion>& assertions() {
  static const std::vector<Assertion> all = [] {
    std::vector<Assertion> both;
    for (const auto part : {assertions_of_papers(), assertions_of_vasilovici()})
      both.insert(both.end(), part.begin(), part.end());
    return both;
  }();
  return all;
}

}  // namespace taut
