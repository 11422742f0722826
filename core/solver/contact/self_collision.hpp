#pragma once

#include <memory>

#include "core/model/scene.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/thread_pool.hpp"

namespace taut {

/// Self-collision by a grid. solver: the pass of the links if it has a target, which moves with the
/// particles; otherwise null.
template <class Real>
std::unique_ptr<Pass<Real>> make_self_collision(const Scene&, Simd, Pass<Real>* solver,
                                                ThreadPool&);

}  // namespace taut
