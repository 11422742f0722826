#pragma once

#include "core/solver/simd/coulomb.hpp"
#include "core/solver/simd/surfaces.hpp"

namespace taut {

/// Rigid motion of a collider over the step: where points fixed to it go. Friction and the
/// continuous test see a particle's motion relative to the collider, x - motion(previous).
template <class Real>
struct RigidMotion {
  bool moves = false;
  Vec3T<Real> turn[3] = {};  ///< rows
  Vec3T<Real> shift = {};    ///< m

  template <class T>
  [[gnu::always_inline]] Vec3T<T> operator()(const Vec3T<T>& p) const {
    if (!moves) return p;
    const Vec3T<T> turned{dot(spread_out<T>(turn[0]), p), dot(spread_out<T>(turn[1]), p),
                          dot(spread_out<T>(turn[2]), p)};
    return turned + spread_out<T>(shift);
  }
};

/// A collider in one step, and its effect on one particle, or on one in every lane.
template <class Real, template <class> class SurfaceOf>
struct Contact {
  SurfaceOf<Real> surface;  ///< at the end of the step
  RigidMotion<Real> motion;
  Real thickness, friction;

  template <class T>
  [[gnu::always_inline]] auto clear(const Vec3T<T>& x) const {
    return surface.clear(x, T(thickness));
  }

  /// Quick test whether x may be inside or, if continuous, may have come from `previous` through
  /// the surface.
  template <bool continuous, class T>
  [[gnu::always_inline]] auto near(const Vec3T<T>& x, const Vec3T<T>& previous) const {
    if constexpr (continuous)
      return !surface.beyond(x, squared_norm(x - motion(previous)), T(thickness));
    else
      return !clear(x);
  }

  /// Moves x, where it is `inside`, out to the nearest point at the scene's thickness, then back
  /// against its slip since `previous`. Returns a mask of where it moved x, which may turn out not
  /// to be inside.
  template <class T, class Mask>
  [[gnu::always_inline]] Mask project(Vec3T<T>& x, const Vec3T<T>& previous,
                                      const Mask& inside) const {
    return push(x, motion(previous), surface.nearest(x), inside);
  }

  /// Like project(), where x is `near`, but moves back to the side from which the particle came in,
  /// even if it has passed through since.
  template <class T, class Mask>
  [[gnu::always_inline]] Mask project_continuous(Vec3T<T>& x, const Vec3T<T>& previous,
                                                 Mask near) const {
    const Vec3T<T> from = motion(previous);
    // Test `beyond` again with half the thickness: few paths come near enough to pay for misses().
    auto passing = near && !surface.beyond(x, squared_norm(x - from), T(thickness / 2));
    if (any(passing)) passing = near && !surface.misses(from, x);
    near = near && !clear(x);
    if (!any(near || passing)) return near;
    const Tangent<T> tangent = side_of_entry(x, from, passing, near);
    return push(x, from, tangent, near);
  }

  /// Moves x out of the half-space where it is deep, then back against its slip from `from`.
  /// Coulomb friction: the tangential correction is at most mu times the normal one, and no more
  /// than the slip.
  template <class T, class Normal, class Mask>
  [[gnu::always_inline]] auto push(Vec3T<T>& x, const Vec3T<T>& from,
                                   const Tangent<T, Normal>& tangent, const Mask& where) const {
    const Normal& normal = tangent.normal;
    const T depth = tangent.offset + T(thickness) - dot(normal, x);
    const auto deep = where && depth > T(0);
    Vec3T<T> out = add_along(x, depth, normal);
    if (friction != 0) {
      const Vec3T<T> slip = across(out - from, normal);
      out = out - FrictionCone{norm(slip), T(friction) * depth}.share(!deep) * slip;
    }
    x = select(deep, out, x);
    return deep;
  }

  /// Whether one vertex is inside, has passed through since `previous` (continuous), or is `held`.
  /// If so, `tangent` is set to the half-space to which it belongs. side: null, or the normal with
  /// which the vertex was last found in this substep; from there it may slide round an edge.
  bool touched(const Vec3T<Real>& x, const Vec3T<Real>& previous, bool continuous, bool held,
               const Vec3T<Real>* side, Tangent<Real>& tangent) const {
    bool inside = held || !apart(x);
    if constexpr (requires { surface.entry(x, x); }) {
      if (continuous) {
        if (side) {
          tangent = surface.nearest(x);
          if (dot(tangent.normal, *side) > Real(-1e-6)) return true;
        }
        const Vec3T<Real> from = motion(previous);
        const bool passing = !surface.beyond(x, squared_norm(x - from), Real(thickness / 2)) &&
                             !surface.misses(from, x);
        if (!inside && !passing) return false;
        tangent = side_of_entry(x, from, passing, inside);
        return inside;
      }
    }
    if (inside) tangent = surface.nearest(x);
    return inside;
  }

 private:
  /// The half-space nearest to x, or the one where x came in if it is `passing`; it then counts as
  /// near.
  template <class T, class Mask>
  [[gnu::always_inline]] Tangent<T> side_of_entry(const Vec3T<T>& x, const Vec3T<T>& from,
                                                  const Mask& passing, Mask& near) const {
    Tangent<T> tangent = surface.nearest(x);
    if (any(passing)) {
      const Entry<T> entry = surface.entry(from, x);
      // Faces of a turned box are perpendicular only up to rounding, which must not decide.
      const auto same_side =
          !surface.clear(x, T(0)) && dot(tangent.normal, entry.tangent.normal) > T(1e-6);
      const auto back = passing && entry.hits;
      tangent = select(back && !same_side, entry.tangent, tangent);
      near = near || back;
    }
    return tangent;
  }

  /// An exact clear().
  bool apart(const Vec3T<Real>& x) const {
    if constexpr (requires { surface.apart(x, thickness); })
      return surface.apart(x, thickness);
    else
      return clear(x);
  }
};

}  // namespace taut
