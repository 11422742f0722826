#include "experiments/truths/assertions/assertions.hpp"

#include "core/model/names.hpp"

namespace taut {

std::string_view to_string(AssertionVerdict verdict) {
  constexpr Names<AssertionVerdict::cannot_be_tested> kNames{"holds", "holds under conditions",
                                                             "does not hold", "cannot be tested"};
  return kNames[verdict];
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
