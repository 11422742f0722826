#pragma once

#include <array>
#include <functional>
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
  /// RMS strain that a law predicts of the cloth at rest, found in some 20 ms; NaN: the law does
  /// not hold. Null: no law is known.
  std::function<double()> stretch_at_rest = {};
  std::string none = "";  ///< why it is not implicit Euler, or why that is not known; "": it is
};

}  // namespace taut
