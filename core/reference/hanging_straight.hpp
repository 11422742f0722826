#pragma once

#include <optional>
#include <vector>

#include "core/model/scene.hpp"

namespace taut::reference {

/// The rest position of every vertex [m] if straight lines decide it: a vertex on a shortest path
/// between two fixed vertices that is as long as their distance is fixed; a vertex that is as far
/// below a fixed one as their shortest path is long cannot hang lower. Nothing if that leaves a
/// vertex open or a link with the wrong length (relative tolerance 1e-9).
std::optional<std::vector<Vec3>> hanging_straight(const Scene&);

}  // namespace taut::reference
