#pragma once

#include "experiments/advise/advisor.hpp"
#include "experiments/answer/answer.hpp"

namespace taut {

/// The best setting, how sure it is, every solver's best beside it, and all that was refused or not
/// done.
Answer answer_of(const AdviceWanted&, const Advice&);

}  // namespace taut
