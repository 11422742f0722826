#pragma once

#include <array>
#include <string>

#include "core/model/mesh.hpp"

namespace taut {

/// Spring constants [N/m] by family; infinite: rigid links, 0: no link.
using Stiffness = std::array<double, kFamilies.size()>;

/// The step that a solver's iterations approximate, as its entry says: implicit Euler with these
/// links and contact of vertices, of each substep.
struct DeclaredStep {
  Stiffness stiffness{};         ///< N/m
  int substeps = 1;              ///< of a step
  std::string of = "a substep";  ///< what its h is
  std::string none = "";         ///< why it is another step, or why none is known; "": it is
};

}  // namespace taut
