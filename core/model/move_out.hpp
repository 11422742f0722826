#pragma once

#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// Moves a point out of all shapes, to `thickness` [m] above their surfaces, in rounds until none
/// moves it. It leaves each shape by the nearest place that is in no other shape, if there is one.
Vec3 moved_out(const std::vector<Shape>&, Vec3 x, double thickness);

/// Displacements [n] [m] that take the free vertices `let_go` out of the colliders of time t [s],
/// with the rest of the cloth following: as far as colliders and pins permit it, links keep the
/// lengths that they have at x, so that neither depth nor strain is left that a step would turn
/// into velocity. Empty if none of them is inside. The scene's pins are those that still hold.
std::vector<Vec3> ways_out(const Scene&, double t, const std::vector<Vec3>& x,
                           const std::vector<int>& let_go);

}  // namespace taut
