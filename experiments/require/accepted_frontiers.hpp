#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/study/frontier/frontier_answer.hpp"

namespace taut {

/// Question of `taut frontier`: how far a setting of one scene goes under several solvers.
struct AcceptedFrontiersWanted {
  CaseSpec base;                     ///< its solver is replaced by each of `solvers`
  std::vector<std::string> solvers;  ///< at least one
  std::string of;                    ///< the setting that grows: "dt", "omega", "wind.strength"
  std::optional<double> from, to;    ///< default: where range_of() starts and stops
  double tolerance = SearchRange{}.tolerance;
  /// Limits (parse_limit()); empty: the default limits of the scene.
  std::vector<std::string> keep;
  CampaignOptions how;
};

struct AcceptedFrontiers {
  std::vector<std::pair<FrontierQuestion, BothFrontiers>> of_solvers;
  std::string limits;  ///< the limits in words

  /// Whether the case of any solver ended with a meaningful result.
  bool any_answered() const;
};

/// Finds the frontiers; nothing if interrupted. Throws InputError.
std::optional<AcceptedFrontiers> find_accepted_frontiers(const AcceptedFrontiersWanted&, Store&);

/// The full answer for one solver, or a table for several.
Answer answer_of(const AcceptedFrontiers&);

}  // namespace taut
