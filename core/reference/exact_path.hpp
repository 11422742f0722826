#pragma once

#include <vector>

#include "core/model/scene.hpp"

namespace taut::reference {

/// Whether exact_path() supports the scene. It excludes contact, bending and wind, which take
/// seconds a run, and pins that let go.
bool has_exact_path(const Scene&);

/// Positions [m] after each of `steps`, ascending, of a run from the scene's start in which every
/// step is the exact one of implicit Euler (ImplicitStep). Precondition: the links' stiffness is
/// finite. Empty if some step has no minimum, or if the scene has no such path.
std::vector<std::vector<Vec3>> exact_path(const Scene&, const std::vector<int>& steps);

}  // namespace taut::reference
