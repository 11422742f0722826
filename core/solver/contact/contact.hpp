#pragma once

#include "core/solver/contact/carry.hpp"
#include "core/solver/contact/surfaces.hpp"

namespace taut {

/// A collider as one step sees it, and what it does to a particle, or to one in every lane.
template <class Real, template <class> class SurfaceOf>
struct Contact {
  SurfaceOf<Real> surface;  ///< at the end of the step
  Carry<Real> carry;
  Real thickness, friction;

  template <class T>
  [[gnu::always_inline]] auto clear(const Triple<T>& x) const {
    return surface.clear(x, T(thickness));
  }

  /// Moves x out to the nearest point at the scene's thickness, then against its slip since
  /// `previous`. Says where it did: not where x was outside.
  template <class T>
  [[gnu::always_inline]] auto project(Triple<T>& x, const Triple<T>& previous) const {
    auto inside = !clear(x);
    if (any(inside)) inside = push(x, carry(previous), surface.nearest(x), inside);
    return inside;
  }

  /// The same, but back to the side from which the particle came in, even if it has passed through
  /// since.
  template <class T>
  [[gnu::always_inline]] auto project_swept(Triple<T>& x, const Triple<T>& previous) const {
    const Triple<T> from = carry(previous);
    auto near = !surface.beyond(x, squared_norm(x - from), T(thickness));
    if (!any(near)) return near;
    const auto passing = near && !surface.misses(from, x);
    near = near && !clear(x);
    if (!any(near || passing)) return near;
    Tangent<T> tangent = surface.nearest(x);
    if (any(passing)) {
      const Entry<T> entry = surface.entry(from, x);
      const auto same_side =
          !surface.clear(x, T(0)) && dot(tangent.normal, entry.tangent.normal) > T(0);
      const auto back = passing && entry.hits;
      tangent = select(back && !same_side, entry.tangent, tangent);
      near = near || back;
    }
    return push(x, from, tangent, near);
  }

 private:
  /// Coulomb: the tangential correction is at most mu times the normal one, and no more than the
  /// slip itself.
  template <class T, class Mask>
  [[gnu::always_inline]] auto push(Triple<T>& x, const Triple<T>& from, const Tangent<T>& tangent,
                                   const Mask& where) const {
    const Triple<T>& normal = tangent.normal;
    const T depth = tangent.offset + T(thickness) - dot(normal, x);
    const auto deep = where && depth > T(0);
    Triple<T> out = x + depth * normal;
    if (friction != 0) {
      Triple<T> slip = out - from;
      slip = slip - dot(normal, slip) * normal;
      const T length = norm(slip), most = T(friction) * depth;
      const auto sticks = length <= most;
      out = out - select(sticks, T(1), most / select(sticks, T(1), length)) * slip;
    }
    x = select(deep, out, x);
    return deep;
  }
};

}  // namespace taut
