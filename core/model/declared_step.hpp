#pragma once

#include <array>
#include <string>

#include "core/model/mesh.hpp"

namespace taut {

/// Spring constants [N/m] by family; infinite: rigid links, 0: no link.
using Stiffness = std::array<double, kFamilies.size()>;

/// The step that a solver's iterations approximate, as its entry declares: implicit Euler of each
/// substep, with these links and contact of vertices.
struct DeclaredStep {
  Stiffness stiffness{};         ///< N/m
  int substeps = 1;              ///< substeps of a step
  std::string of = "a substep";  ///< the interval of one step of implicit Euler
  std::string none = "";  ///< why it is not implicit Euler, or why that is not known; "": it is
};

}  // namespace taut
