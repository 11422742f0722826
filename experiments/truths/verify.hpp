#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/truths/verification.hpp"

namespace taut {

/// The truths to check, and how.
struct VerifyRequest {
  std::vector<const TruthEntry*> truths;  ///< in the order of the answer
  std::vector<std::string> solvers;       ///< only findings of these; empty: all
  int jobs = 2;                           ///< truths at the same time
  bool here = false;  ///< run in this process instead of one process for each truth
  std::function<void(std::size_t done, std::size_t total)> progress = [](std::size_t, std::size_t) {
  };
};

/// All truths, by section and row.
std::vector<const TruthEntry*> truths_in_order();
/// Whether an assertion of a publication rests on this truth.
bool is_asserted(const TruthEntry&);

/// Checks the truths and judges the assertions that rest on them. A truth whose process crashes,
/// hangs or exhausts its memory is broken. Throws InputError if a shipped scene is missing.
Verification verify(const VerifyRequest&);

}  // namespace taut
