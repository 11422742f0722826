#pragma once

#include <filesystem>
#include <vector>

#include "experiments/case/case.hpp"

namespace taut {

/// Variants of a simulation that differ only by chance.
struct Perturbations {
  /// One free vertex starts displaced by 2^-23 of the cloth's extent. The effect of that is noise.
  std::vector<CaseSpec> rounding;
  /// The links come in another order, which is another path to the same model. Results may differ
  /// by more than rounding if sweeps do not converge. Empty if the solver has no such option.
  std::vector<CaseSpec> order;
};

/// Makes the perturbed cases, and writes their scenes to `folder`. Throws InputError if that fails.
Perturbations perturbations(const Case&, const std::filesystem::path& folder);

}  // namespace taut
