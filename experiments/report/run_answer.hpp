#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/study.hpp"

namespace taut::report {

/// The answer of `taut run`: how the cases ended, and for each study a table for each of `values`,
/// which are metric values or kFailureMap.
Answer run_answer(const CampaignProgress&, const std::vector<Study>&,
                  const std::vector<std::string>& values, const Store&);

/// "trade: 20 cases: ok 18, exploded 2", and the solvers whose work is unequal.
std::string ends_of(const Study&, const Store&);

}  // namespace taut::report
