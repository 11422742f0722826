#pragma once

#include <memory>
#include <span>

#include "core/solver/layout/particles.hpp"

namespace taut {

/// Block Gauss-Seidel along the lines of a grid: the structural links of each row, then of each
/// column, are solved at once, and `others` (null: none) goes over the rest. With u_i = d_i/|d_i|
/// of link i, from vertex i to i + 1, and C_i = |d_i| - r_i,
///
///     (w_i + w_i+1) l_i - w_i u_i-1.u_i l_i-1 - w_i+1 u_i.u_i+1 l_i+1 = C_i
///     x_i += w_i (l_i u_i - l_i-1 u_i-1)
///
/// a tridiagonal system (Thomas' algorithm, in double), right to first order in the lengths. It is
/// singular where a straight line hangs between two pins: its diagonal is larger by a share of its
/// largest entry, 1e-8, or in float 1e-5, so that such a line shares out what it is too long or
/// too short.
/// Precondition: scene.mesh.grid. w: inverse masses [1/kg].
template <class Real>
std::unique_ptr<Pass<Real>> make_lines(const Scene&, std::span<const double> w,
                                       std::unique_ptr<Pass<Real>> others);

/// h^2 T/(m l): h the substep [s], T the weight of the cloth over the number of its pins [N], m the
/// least mass [kg] and l the shortest structural link [m]. 0: no pins.
///
/// The pull of a line acts in the directions that links have before they are solved: an explicit
/// step across the line. With mu = 1 - h^2 lambda of a wave whose Laplacian is lambda,
/// z^2 - 2 mu z + mu = 0 has |z| <= 1 down to mu = -1/3, and lambda is at most 4 T/(m l): a
/// straight line of equal masses with the same pull all along is stable up to 1/3.
double line_tension(const Scene&, double h);
inline constexpr double kLargestLineTension = 1.0 / 3;

}  // namespace taut
