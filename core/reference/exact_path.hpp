#pragma once

#include <vector>

#include "core/model/declared_step.hpp"
#include "core/model/scene.hpp"

namespace taut::reference {

/// Places [m] after each of `steps`, ascending, of a run in which every step is the exact one of
/// implicit Euler (ImplicitStep), from the scene's start; stiffness in N/m, finite. Empty: some
/// step has no minimum, or the scene has bending, contact (a minute on `ball`) or pins that let go.
std::vector<std::vector<Vec3>> exact_path(const Scene&, const Stiffness&,
                                          const std::vector<int>& steps);

}  // namespace taut::reference
