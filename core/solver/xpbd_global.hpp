#pragma once

#include <array>

#include "core/solver/loop.hpp"

namespace taut {

/// Solves XPBD's links all at once, by Newton's method on the multipliers. This is the fast
/// projection of Goldenthal et al., Efficient Simulation of Inextensible Cloth (SIGGRAPH 2007),
/// with compliance, and the outer iteration of multigrid-accelerated XPBD (MGPBD) with a direct
/// solver inside.
///
/// With C = |x_b - x_a| - rest and its gradients J at x, the inverse masses W, a = 1/(K h^2),
/// lambda = 0 and x = y at every substep, an iteration is
///
///     (J W J^T + a) dlambda = -(C + a lambda),   lambda += dlambda,   x += W J^T dlambda
///
/// -lambda/h^2 is the tension [N]. Once C + a lambda = 0, x is a step of implicit Euler with the
/// directions that each dlambda had. These differ from the directions at x where links turn within
/// a step. With primal=on, p = x - y - W J^T lambda measures the difference, M = W^-1, and
///
///     (J V J^T + a) dlambda = -(C + a lambda) + J V M p,   x += s (V J^T dlambda - V M p)
///
/// is a Gauss-Newton step down implicit Euler's energy, with s in (0, 1] so that the energy falls.
/// It ends in implicit Euler's step itself. V is W where no link pulls. Elsewhere its masses are
/// larger by the resistance of tension across links, -lambda/|d| of each; without this (V = W)
/// steps overshoot, and 64 of them leave a thousand times as much.
///
/// Rigid links have a = 1e-9 of the matrix' mean diagonal. A sheet with shear links has more links
/// than degrees of freedom, and without this there is no factor. What such links leave undetermined
/// amplifies rounding by up to 1e9: where contact pushes against it, too, two runs that differ by
/// rounding diverge within a dozen steps. The matrix couples links that share a vertex that moves.
/// Its pattern is analysed once and its factor made in every iteration, both in double precision.
/// If there is no factor, positions become NaN, which ends a case as exploded.
///
/// The factor stays cheaper than conjugate gradients with the matrix' diagonal at every size that
/// was tried. On sheets of 128 x 128 with shear links a solution takes 0.3 s; 1617 iterations to
/// 1e-4 take five times as long at 1e4 N/m, and more the stiffer the links. Both grow as the cube
/// of a side. At 256 x 256 a solution takes 3.3 s and 0.6 GB of memory.
///
/// Bending is projected by the loop after each solution, as after sweeps. So is contact, except
/// with primal=on: then it is part of the energy (core/solver/contact/augmented_contacts.hpp), and
/// h^2 times its stiffness is part of the masses in V, a matrix at each vertex that touches.
/// Contact in the solve without the primal residual was tried: sheets that fall on a ball, a box or
/// a floor are compressed and explode, with 3 and with 10 solutions. A compressed link pushes along
/// a direction that turns away under it: a slack sheet blows up with few solutions, and ends as
/// extreme or exploded (results/benchmarks/failure-map.md).
///
/// The number of solutions that a step needs grows with the number of links of a chain if the
/// residual of the first solution does. A chain that is released from the side turns at its pin by
/// h^2 g/l in a step, and the pull of N links across that angle moves its vertex by N^3 (h^2
/// g/L)^2/2 of a link: by one link at h = 1/64 s, L = 1 m and N = 70. To reach a residual of 1e-4
/// of the first takes 2, 3, 7 and 20 solutions with 16, 32, 64 and 128 links, and 2 with each in
/// steps of h ~ N^(-3/4). With steps halved until lengths are nearer it takes 2, 3, 11 and 49. With
/// directions at x_t the first solution is nearly exact (2, 2, 2, 3), but such steps lose no
/// energy: they are not implicit Euler's.
///
/// stiffness: K [N/m] by family; infinite: rigid.
template <class Real>
loop::Links<Real> make_global_links(const loop::Setup&,
                                    const std::array<double, kFamilies.size()>& stiffness,
                                    bool primal);

}  // namespace taut
