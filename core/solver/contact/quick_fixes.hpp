#pragma once

#include <memory>

#include "core/model/scene.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/thread_pool.hpp"

namespace taut {

/// The two quick fixes for a particle that enters a collider, as published: Response::freeze and
/// Response::halt.
template <class Real>
std::unique_ptr<Pass<Real>> make_freeze(const Collider&, const Scene&, Simd, ThreadPool&);
template <class Real>
std::unique_ptr<Pass<Real>> make_halt(const Collider&, const Scene&, Simd, ThreadPool&);

}  // namespace taut
