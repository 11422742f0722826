#pragma once

#include <string>
#include <vector>

#include "experiments/answer/answer.hpp"

namespace taut {

/// Which answers are probed: of elastic links without contact, the same on bodies, or of rigid
/// links.
enum class ProbePart { free, contact, rigid };
std::vector<std::string> probe_parts();  ///< "free", "contact", "rigid"

/// How near the distance that reference::StepError tells is to the true one, from the exact step:
/// scenes times solvers times twelve settings each. The exact step is Newton's method's from the
/// start of the step (reference::ImplicitStep), with bending or where that does not converge the
/// solver `implicit`'s. An answer that is refused is a miss; one that is within a micrometre of the
/// exact step is a hit if it is told to be. `scenes`: empty, all of them.
Answer error_probes(const std::vector<ProbePart>&, const std::vector<std::string>& scenes);

}  // namespace taut
