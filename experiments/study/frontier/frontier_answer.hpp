#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"
#include "experiments/study/frontier/frontier.hpp"

namespace taut {

/// How far one solver is stable, and how far what it does is acceptable, too.
struct BothFrontiers {
  CaseFrontier stable, acceptable;
};

/// Both searches; the second one finds most of its cases stored. What did not complete is not
/// acceptable, either; of the rest `unacceptable` says why not.
BothFrontiers find_both(const FrontierQuestion&, Store&, const CampaignOptions&,
                        const Judge& unacceptable);

/// The answer of `taut frontier` for one solver.
Answer answer_of(const FrontierQuestion&, const BothFrontiers&, const std::optional<Prediction>&);

/// Its answer for several solvers of one scene, a row each; `acceptable`: what is, in words.
Answer answer_of(const std::vector<std::pair<FrontierQuestion, BothFrontiers>>&,
                 const std::string& acceptable);

/// What the first case that did not end well says; "": all ended well.
std::string not_answered_because(const CaseFrontier&);

}  // namespace taut
