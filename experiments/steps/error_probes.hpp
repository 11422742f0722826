#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"

namespace taut {

/// Subject of the probes: elastic links without contact, elastic links in contact with bodies, or
/// rigid links.
enum class ProbePart { free, contact, rigid };
std::vector<std::string> probe_parts();  ///< "free", "contact", "rigid"

/// Compares reference::StepError's estimate of the distance from the exact step with the true
/// distance, for each scene and solver at twelve settings. The exact step is that of Newton's
/// method from the start of the step (reference::ImplicitStep); with bending, or where Newton's
/// method does not converge, it is that of the solver `implicit`. A refused estimate is a miss. For
/// a result within a micrometre of the exact step, an estimate of at most two micrometres is a hit.
/// An empty `scenes` stands for all.
Answer error_probes(const std::vector<ProbePart>&, const std::vector<std::string>& scenes);

}  // namespace taut
