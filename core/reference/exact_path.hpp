#pragma once

#include <vector>

#include "core/model/scene.hpp"

namespace taut::reference {

/// Whether exact_path computes a way: without contact, bending and wind, which take seconds a run,
/// and without pins that let go.
bool has_exact_path(const Scene&);

/// Places [m] after each of `steps`, ascending, of a run in which every step is the exact one of
/// implicit Euler (ImplicitStep), from the scene's start; the links' stiffness is finite. Empty:
/// some step has no minimum, or the scene has no such path.
std::vector<std::vector<Vec3>> exact_path(const Scene&, const std::vector<int>& steps);

}  // namespace taut::reference
