#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"

namespace taut {

/// What is probed: elastic links without contact, elastic links in contact with bodies, or rigid
/// links.
enum class ProbePart { free, contact, rigid };
std::vector<std::string> probe_parts();  ///< "free", "contact", "rigid"

/// Probes how close the distance that reference::StepError estimates comes to the true distance
/// from the exact step, for scenes times solvers times twelve settings each. The exact step is that
/// of Newton's method from the start of the step (reference::ImplicitStep), or that of the solver
/// `implicit` with bending or where Newton's method does not converge. A refused estimate is a
/// miss. For a result within a micrometre of the exact step, an estimate that says so is a hit. An
/// empty `scenes` stands for all.
Answer error_probes(const std::vector<ProbePart>&, const std::vector<std::string>& scenes);

}  // namespace taut
