#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/study/frontier/frontier.hpp"

namespace taut {

/// How far a solver is stable, and how far its results are acceptable.
struct BothFrontiers {
  CaseFrontier stable, acceptable;
};

/// Runs both searches; the second finds most of its cases stored. A case that did not complete is
/// not acceptable; for the others `unacceptable` says why not.
BothFrontiers find_both(const FrontierQuestion&, Store&, const CampaignOptions&,
                        const Judge& unacceptable);

/// The answer of `taut frontier` for one solver.
Answer answer_of(const FrontierQuestion&, const BothFrontiers&, const std::optional<Prediction>&);

/// The answer of `taut frontier` for several solvers of one scene, one row each. `acceptable` says
/// in words what is acceptable.
Answer answer_of(const std::vector<std::pair<FrontierQuestion, BothFrontiers>>&,
                 const std::string& acceptable);

/// Reason of the first case that did not end well; "" if all did.
std::string not_answered_because(const CaseFrontier&);

}  // namespace taut
