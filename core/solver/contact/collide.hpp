#pragma once

#include <memory>

#include "core/model/scene.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/thread_pool.hpp"

namespace taut {

/// Moves particles out of a collider. continuous: also those that passed through it since the step
/// began.
template <class Real>
std::unique_ptr<Pass<Real>> make_collide(const Collider&, const Scene&, const Layout&,
                                         bool continuous, Simd, ThreadPool&);

}  // namespace taut
