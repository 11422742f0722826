#pragma once

#include "core/solver/triple.hpp"

namespace taut {

/// Where a collider takes the points that are fixed to it during one step. Friction and the swept
/// test see a particle's motion relative to the collider: x - carry(previous).
template <class Real>
struct Carry {
  bool moves = false;
  Triple<Real> turn[3] = {};  ///< rows
  Triple<Real> shift = {};    ///< m

  template <class T>
  [[gnu::always_inline]] Triple<T> operator()(const Triple<T>& p) const {
    if (!moves) return p;
    const Triple<T> turned{dot(spread_out<T>(turn[0]), p), dot(spread_out<T>(turn[1]), p),
                           dot(spread_out<T>(turn[2]), p)};
    return turned + spread_out<T>(shift);
  }
};

}  // namespace taut
