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

/// The answer of `taut frontier` for one solver.
Answer answer_of(const FrontierQuestion&, const BothFrontiers&, const std::optional<Prediction>&);

/// The same of several solvers, a row each; `acceptable`: what is, in words.
Table table_of(const std::vector<std::pair<FrontierQuestion, BothFrontiers>>&,
               const std::string& acceptable);

/// What the first case that did not end well says; "": all ended well.
std::string not_answered_because(const CaseFrontier&);

}  // namespace taut
