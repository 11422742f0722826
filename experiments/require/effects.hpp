#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/case/case.hpp"
#include "experiments/require/draft.hpp"

namespace taut {

/// One reduction of a model: its description, and its change to a draft.
struct Reduction {
  std::string change;  ///< for people: "gone", "5 -> 2"
  std::function<void(Draft&)> apply;
  bool removes = false;  ///< nothing of the effect is left
};

/// A part of a model that may not be needed, or a number that may be coarser.
struct Effect {
  std::string name;                   ///< "bend links", "substeps"
  std::vector<Reduction> reductions;  ///< from the weakest to the strongest; at least one
};

/// Everything in a case that can be removed or coarsened: bend and shear links, bending, wind and
/// its law, damping, friction, each collider, self-collision, contact of faces, continuous
/// detection, thickness, tethers, levels, substeps, sweeps, precision, resolution, duration. Lists
/// only what the case has.
std::vector<Effect> effects_of(const Case&);

}  // namespace taut
