#pragma once

#include <memory>
#include <span>

#include "core/solver/layout/particles.hpp"

namespace taut {

/// Block Gauss-Seidel along the lines of a grid. Solves the structural links of each row at once,
/// then those of each column, and then applies `others` to the remaining links (null: none remain).
/// With u_i = d_i/|d_i| of link i, from vertex i to i + 1, and C_i = |d_i| - r_i,
///
///     (w_i + w_i+1) l_i - w_i u_i-1.u_i l_i-1 - w_i+1 u_i.u_i+1 l_i+1 = C_i
///     x_i += w_i (l_i u_i - l_i-1 u_i-1)
///
/// This is a tridiagonal system (Thomas' algorithm, in double), correct to first order in the
/// lengths. It is singular where a straight line hangs between two pins. Its diagonal is therefore
/// raised by a share of its largest entry, 1e-8, or 1e-5 in float, so that such a line spreads its
/// excess or missing length over its links.
/// Precondition: scene.mesh.grid. w: inverse masses [1/kg].
template <class Real>
std::unique_ptr<Pass<Real>> make_lines(const Scene&, std::span<const double> w,
                                       std::unique_ptr<Pass<Real>> others);

/// Dimensionless tension of the lines, h^2 T/(m l): h is the substep [s], T the weight of the cloth
/// divided by the number of its pins [N], m the least mass [kg] and l the shortest structural link
/// [m]. Returns 0 without pins.
///
/// A line pulls in the directions that its links had before they were solved, so across the line it
/// is an explicit step. For a wave whose Laplacian is lambda, with mu = 1 - h^2 lambda, the roots
/// of z^2 - 2 mu z + mu = 0 have |z| <= 1 down to mu = -1/3. lambda is at most 4 T/(m l), so a
/// straight line of equal masses and uniform tension is stable up to 1/3.
double line_tension(const Scene&, double h);
/// Largest line_tension() with which a line is stable.
inline constexpr double kLargestLineTension = 1.0 / 3;

}  // namespace taut
