#pragma once

#include <cstddef>
#include <vector>

namespace taut {

/// x, y, z and, in positions, the inverse mass w [1/kg] (0: pinned).
template <class Real>
struct alignas(4 * sizeof(Real)) Vec4 {
  Real x, y, z, w;
};

/// The cloth as Jakobsen keeps it: no velocities, only where each particle is and where it was.
template <class Real>
struct Particles {
  std::vector<Vec4<Real>> x;         ///< position [m] and inverse mass
  std::vector<Vec4<Real>> previous;  ///< position one step ago [m]
  std::vector<Vec4<Real>> a;         ///< acceleration of this step [m/s^2]
  std::size_t size() const { return x.size(); }
};

}  // namespace taut
