#pragma once

#include <filesystem>
#include <vector>

#include "experiments/case/case.hpp"

namespace taut {

/// The same simulation with differences that mean nothing: what it moves by under them is noise.
struct Perturbations {
  std::vector<CaseSpec> rounding;  ///< one free vertex starts off by 2^-23 of the cloth's extent
  std::vector<CaseSpec> order;     ///< the links in another order; empty: the solver offers none
};

/// Scenes that are made for it are written to `folder`. Throws InputError if they cannot be.
Perturbations perturbations(const Case&, const std::filesystem::path& folder);

}  // namespace taut
