#pragma once

#include <array>

#include "core/solver/loop.hpp"

namespace taut {

/// XPBD's links solved all at once, by Newton's method on the multipliers: the fast projection of
/// Goldenthal et al., Efficient Simulation of Inextensible Cloth (SIGGRAPH 2007), with compliance;
/// the outer iteration of multigrid-accelerated XPBD (MGPBD) with a direct solver in its place.
///
/// With C = |x_b - x_a| - rest and its gradients J at x, W the inverse masses, a = 1/(K h^2),
/// lambda = 0 and x = y at every substep, an iteration is
///
///     (J W J^T + a) dlambda = -(C + a lambda),   lambda += dlambda,   x += W J^T dlambda
///
/// -lambda/h^2 is the tension [N]. Once C + a lambda = 0, x is a step of implicit Euler with
/// the directions that each dlambda had, which differ from those at x where links turn within a
/// step. With primal=on, p = x - y - W J^T lambda says by how much, M = W^-1, and
///
///     (J V J^T + a) dlambda = -(C + a lambda) + J V M p,   x += s (V J^T dlambda - V M p)
///
/// is a step of Gauss and Newton down implicit Euler's energy, which s in (0, 1] makes fall: its
/// end is implicit Euler's step itself. V is W where no link pulls; else masses are larger in it by
/// what tension resists across links, -lambda/|d| of each, without which (V = W) steps overshoot
/// and 64 of them leave a thousand times as much.
///
/// Rigid links have 1e-9 of the matrix' mean diagonal for a: a sheet with shear links has more
/// links than places to choose, and without it no factor. What such links leave to choose takes up
/// rounding by as much as 1e9 times: where contact pushes against it, too, two runs that differ by
/// rounding part within a dozen steps. The matrix couples links that share a
/// vertex that moves; its pattern is analysed once, its factor made in every iteration, both in
/// double precision. Where there is no factor, places are NaN, which ends a case as exploded.
///
/// The factor stays cheaper than conjugate gradients with the matrix' diagonal at any size that was
/// tried: on sheets of 128 x 128 with shear links a solution is 0.3 s, and 1617 iterations to 1e-4
/// take five times as long at 1e4 N/m and more the stiffer links are; both grow as the cube of a
/// side. At 256 x 256 a solution is 3.3 s and its memory 0.6 GB.
///
/// Bending is projected by the loop after each solution, as after sweeps. So is contact, which with
/// primal=on is part of the energy (core/solver/contact/augmented_contacts.hpp), h^2 times its
/// stiffness part of the masses in V, a matrix at each vertex that touches. The same in the solve
/// without the primal residual was tried: pressed together by what pushes, sheets that fall on a
/// ball, a box or a floor explode, with 3 and with 10 solutions. A compressed link pushes along a
/// direction that turns away under it: a sheet that is slack blows up with few solutions, and ends
/// as extreme or exploded (results/benchmarks/failure-map.md).
///
/// Solutions of a step grow with the links of a chain where what the first leaves does: one that is
/// let go from the side turns at its pin by h^2 g/l in a step, and the pull of N links across that
/// angle moves its vertex by N^3 (h^2 g/L)^2/2 of a link, one at h = 1/64 s, L = 1 m and N = 70.
/// To a residual of 1e-4 of the first it takes 2, 3, 7 and 20 solutions with 16, 32, 64 and 128
/// links, and 2 with each in steps of h ~ N^(-3/4). Halved until lengths are nearer they are 2, 3,
/// 11 and 49; from directions at x_t the first is exact nearly (2, 2, 2, 3), but such steps lose no
/// energy: they are not implicit Euler's.
///
/// stiffness: K [N/m] by family; infinite: rigid.
template <class Real>
loop::Links<Real> make_global_links(const loop::Setup&,
                                    const std::array<double, kFamilies.size()>& stiffness,
                                    bool primal);

}  // namespace taut
