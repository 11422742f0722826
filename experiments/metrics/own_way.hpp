#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// Number of steps in which a cloth shows whether it moves, by the scene's extent; a fixed number
/// without gravity.
int first_steps(const Scene&);
/// Their time T for a help text: its formula, and that of a square metre in seconds.
std::string first_time_text();

/// Most free vertices of a cloth whose exact steps a metric computes.
inline constexpr std::size_t kMostFree = 2500;

/// Mean displacement [m] of the pins until time t, which carries the cloth along.
Vec3 way_of_pins(const Scene&, double t);

/// Mean over vertices, weighted by their masses.
Vec3 weighted_mean(const Scene&, const std::vector<Vec3>& all);

/// Subtracts from the displacements [m] of all vertices until time t those of a cloth that keeps
/// its shape: the displacement of its pins or, without pins, its fall, which no solver of links can
/// miss.
void keep_own_way(const Scene&, double t, std::vector<Vec3>& ways);

}  // namespace taut
