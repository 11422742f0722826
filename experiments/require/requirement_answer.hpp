#pragma once

#include <limits>
#include <string>

#include "experiments/answer/answer.hpp"
#include "experiments/require/require.hpp"

namespace taut {

/// What goes and what stays, in words. It is written to an answer and read back from one.
struct RequirementSummary {
  std::string scene, solver;
  std::string chaotic;  ///< "no", or from when on
  std::string kept, can_go = "nothing", required = "-";
  double time_left = std::numeric_limits<double>::quiet_NaN();  ///< share of the CPU time
};
RequirementSummary summary_of(const Requirement&);

/// `bytes`: of a step of the full model; `seconds` of the patience were used.
Answer answer_of(const Requirement&, std::size_t bytes, const std::string& picture, double seconds,
                 double patience);
RequirementSummary requirement_in(const Answer&);

}  // namespace taut
