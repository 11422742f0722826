#pragma once

#include <vector>

#include "core/model/declared_step.hpp"
#include "core/model/scene.hpp"

namespace taut::reference {

/// How far positions are from implicit Euler's conditions at a collider, from the positions alone.
struct ContactResidual {
  double most = 0;   ///< m, as the distance that a vertex travels by its own inertia
  int touching = 0;  ///< vertices without a gap
};

/// Residual of the step from state `from` at time t [s] that ends in x. With r [m], the
/// displacement of a vertex by the force that inertia and links leave over, and the gap and the
/// slip relative to the collider, it is the larger of
///
///     | r_n - max(0, r_n - gap) |,    | r_t - P(r_t - slip) |
///
/// over all vertices that move, where P limits the length to mu max(0, r_n) (Alart, Curnier 1991).
/// Precondition: the scene has one collider, no bending, no wind and no self-collision.
ContactResidual contact_residual(const Scene&, const State& from, double t, const Stiffness&,
                                 const std::vector<Vec3>& x);

}  // namespace taut::reference
