#pragma once

#include "core/solver/simd/vectors.hpp"

namespace taut {

/// Coulomb's bound on a tangent, in every lane: on a force of friction, or on the slip that
/// friction takes back.
template <class T>
struct FrictionCone {
  T length;  ///< of the tangent
  T most;    ///< mu times the push, or times the depth

  /// Whether the tangent is within the cone.
  [[gnu::always_inline]] auto sticks() const { return length <= most; }
  /// Share of the tangent that is within the cone: 1, or the bound over the length. Also 1 where
  /// the answer is `unused`, since the length may be 0 there.
  template <class Mask = bool>
  [[gnu::always_inline]] T share(const Mask& unused = {}) const {
    const auto whole = sticks() || unused;
    return select(whole, T(1), most / select(whole, T(1), length));
  }
};
template <class T>
FrictionCone(T, T) -> FrictionCone<T>;

}  // namespace taut
