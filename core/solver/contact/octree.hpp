#pragma once

#include <memory>

#include "core/model/scene.hpp"
#include "core/solver/layout/particles.hpp"

namespace taut {

/// Self-collision as published, by an octree.
template <class Real>
std::unique_ptr<Pass<Real>> make_octree(const Scene&);

}  // namespace taut
