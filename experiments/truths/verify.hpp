#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/truths/verification.hpp"

namespace taut {

/// Which truths are checked, and how.
struct VerifyRequest {
  std::vector<const TruthEntry*> truths;  ///< in the order of the answer
  std::vector<std::string> solvers;       ///< only what binds these; empty: all
  int jobs = 2;                           ///< truths at a time
  bool here = false;                      ///< in this process, not each in one of its own
  std::function<void(std::size_t done, std::size_t total)> progress = [](std::size_t, std::size_t) {
  };
};

/// All truths, by section and row.
std::vector<const TruthEntry*> truths_in_order();
/// Whether an assertion of a publication rests on it.
bool is_asserted(const TruthEntry&);

/// Checks the truths and judges the assertions that rest on them. A truth whose process crashes,
/// hangs or eats memory is broken. Throws InputError of a shipped scene that is missing.
Verification verify(const VerifyRequest&);

}  // namespace taut
