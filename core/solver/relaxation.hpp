#pragma once

#include <memory>
#include <span>

#include "core/model/scene.hpp"
#include "core/solver/jakobsen_params.hpp"
#include "core/solver/pass.hpp"
#include "core/solver/team.hpp"

namespace taut {

/// The sweep over all links, and where it wants the particles to be.
template <class Real>
struct Relaxation {
  Layout layout;
  std::unique_ptr<Pass<Real>> pass;  ///< null: no link can move
};

/// Chooses by method, order and layout. w: inverse masses.
template <class Real>
Relaxation<Real> make_relaxation(const Scene&, std::span<const double> w, const Params&, Team&);

/// What the parameters ask to do before each sweep: coarse levels, then tethers.
template <class Real>
std::vector<std::unique_ptr<Pass<Real>>> make_accelerators(const Scene&, std::span<const double> w,
                                                           const Params&);

}  // namespace taut
