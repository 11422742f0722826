#pragma once

#include <filesystem>
#include <vector>

#include "experiments/case/case.hpp"

namespace taut {

/// The same simulation with differences that nobody asked for.
struct Perturbations {
  /// One free vertex starts off by 2^-23 of the cloth's extent: what that moves is noise.
  std::vector<CaseSpec> rounding;
  /// The links in another order: another path to the same model, whose results may differ by more
  /// than rounding where sweeps do not converge; empty: the solver offers none.
  std::vector<CaseSpec> order;
};

/// Scenes that are made for it are written to `folder`. Throws InputError if they cannot be.
Perturbations perturbations(const Case&, const std::filesystem::path& folder);

}  // namespace taut
