#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/study/frontier/frontier_answer.hpp"

namespace taut {

/// How far a setting of one scene goes under several solvers: `taut frontier`.
struct AcceptedFrontiersWanted {
  CaseSpec base;                     ///< its solver is replaced by each of `solvers`
  std::vector<std::string> solvers;  ///< at least one
  std::string of;                    ///< the setting that grows: "dt", "omega", "wind.strength"
  std::optional<double> from, to;    ///< else where range_of() starts and stops
  double tolerance = SearchRange{}.tolerance;
  std::vector<std::string> keep;  ///< limits (parse_limit()); none: what the scene accepts
  CampaignOptions how;
};

struct AcceptedFrontiers {
  std::vector<std::pair<FrontierQuestion, BothFrontiers>> of_solvers;
  std::string limits;  ///< what was acceptable, in words

  /// Whether any solver's case came to an end that says something.
  bool any_answered() const;
};

/// Nothing: interrupted. Throws InputError.
std::optional<AcceptedFrontiers> find_accepted_frontiers(const AcceptedFrontiersWanted&, Store&);

/// Of one solver all that was found, of several a table.
Answer answer_of(const AcceptedFrontiers&);

}  // namespace taut
