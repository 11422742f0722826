#pragma once

#include "experiments/advise/advisor.hpp"
#include "experiments/answer/answer.hpp"

namespace taut {

/// The answer of `taut advise`: the best setting, its certainty, every solver's best, and
/// everything that was refused or not done.
Answer answer_of(const AdviceWanted&, const Advice&);

}  // namespace taut
