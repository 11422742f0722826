#pragma once

#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// Steps in which a cloth shows whether it moves: T = 1.3 sqrt(L/g), L the scene's extent, half a
/// second where a square metre hangs; 32 steps where there is no gravity.
int first_steps(const Scene&);

/// How far [m] the pins have gone in the mean until time t: the cloth is carried that far.
Vec3 way_of_pins(const Scene&, double t);

/// The mean of what vertices have, weighted by their masses.
Vec3 weighted_mean(const Scene&, const std::vector<Vec3>& all);

/// Takes from the ways [m] of all vertices until time t what a cloth does that keeps its shape: the
/// way of its pins, or without any its fall, which no solver of links can miss.
void keep_own_way(const Scene&, double t, std::vector<Vec3>& ways);

}  // namespace taut
