#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/study/campaign.hpp"
#include "experiments/study/study.hpp"

namespace taut::report {

/// What `taut run` answers: how the cases ended, and of each study a table for each of `values`, a
/// metric's value or kFailureMap.
Answer run_answer(const CampaignProgress&, const std::vector<Study>&,
                  const std::vector<std::string>& values, const Store&);

/// "trade: 20 cases: ok 18, exploded 2", with the solvers whose work is unequal.
std::string ends_of(const Study&, const Store&);

}  // namespace taut::report
