#pragma once

#include <cstddef>

namespace taut {

/// A link of an elastic solver, with the energy K/2 C^2 where C = |x_b - x_a| - rest.
struct Spring {
  std::size_t a = 0, b = 0;  ///< vertices
  double rest = 0;           ///< m
  double stiffness = 0;      ///< K, N/m
};

}  // namespace taut
