#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/require/draft.hpp"

namespace taut {

/// One step towards less: what it does, in words, and to a draft.
struct Reduction {
  std::string change;  ///< "gone", "5 -> 2"
  std::function<void(Draft&)> apply;
};

/// A part of a model that may not be needed, or a number that may be coarser than it is.
struct Effect {
  std::string name;                   ///< "bend links", "substeps"
  std::vector<Reduction> reductions;  ///< from the weakest to the strongest; one at least
};

/// What there is to take away or to coarsen in a case: bend and shear links, bending, wind and its
/// law, damping, friction, each collider, self-collision, contact of faces, continuous detection,
/// thickness, tethers, levels, substeps, sweeps, precision, resolution, duration. What the case
/// does not have is not listed.
std::vector<Effect> effects_of(const Case&);

}  // namespace taut
