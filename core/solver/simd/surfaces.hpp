#pragma once

#include <limits>

#include "core/solver/simd/vectors.hpp"

namespace taut {

struct Plane;
struct Ball;
struct Box;
struct Capsule;

/// The half-space normal . x >= offset that touches a surface where a point belongs to it.
template <class T, class Normal = Vec3T<T>>
struct Tangent {
  Normal normal;
  T offset;  ///< m
};
template <class Mask, class T>
[[gnu::always_inline]] inline Tangent<T> select(const Mask& mask, const Tangent<T>& yes,
                                                const Tangent<T>& no) {
  return {select(mask, yes.normal, no.normal), select(mask, yes.offset, no.offset)};
}

/// Where a path meets a solid; `tangent` is valid only where `hits`.
template <class T>
struct Entry {
  decltype(T() < T()) hits;
  Tangent<T> tangent;
};

// Colliders at one moment, in the form that the contact loops need: closed forms in the solver's
// own precision, for a point or one in every lane. surface() of core/model/collider.hpp is their
// oracle.
//
//   clear(x, t)       quick and conservative: true only if x is at least t from the surface
//   beyond(x, w2, t)  the same for a whole path that ends in x and whose squared length is w2
//   misses(from, to)  quick and conservative: true only if entry(from, to) hits nothing
//   nearest(x)        tangent at the surface point nearest to x
//   entry(from, to)   tangent where a straight path first meets the solid; the one nearest to
//                     `from` if it starts inside

/// The normal (0, 1, 0) as a compile-time constant: multiplications by its zeros are left out.
struct Up {};
template <class T>
[[gnu::always_inline]] inline T dot(Up, const Vec3T<T>& a) {
  return a.y;
}
template <class T>
[[gnu::always_inline]] inline Vec3T<T> add_along(const Vec3T<T>& a, T by, Up) {
  return {a.x, a.y + by, a.z};
}
template <class T>
[[gnu::always_inline]] inline Vec3T<T> add_along(const Vec3T<T>& a, T by, const Vec3T<T>& normal) {
  return a + by * normal;
}
/// The part of `a` that is tangential to the surface.
template <class T>
[[gnu::always_inline]] inline Vec3T<T> across(const Vec3T<T>& a, Up) {
  return {a.x, T(0), a.z};
}
template <class T>
[[gnu::always_inline]] inline Vec3T<T> across(const Vec3T<T>& a, const Vec3T<T>& normal) {
  return a - dot(normal, a) * normal;
}

/// A half-space above a floor: the normal is (0, 1, 0).
template <class Real>
struct LevelPlaneSurface {
  Real offset;  ///< m

  template <class T>
  [[gnu::always_inline]] auto clear(const Vec3T<T>& x, T thickness) const {
    return x.y >= T(offset) + thickness;
  }
  template <class T>
  [[gnu::always_inline]] Tangent<T, Up> nearest(const Vec3T<T>&) const {
    return {{}, T(offset)};
  }
};

/// A half-space has no other side to pass to, so nearest() is enough.
template <class Real>
struct PlaneSurface {
  using Shape = Plane;
  Vec3T<Real> normal;
  Real offset;  ///< m

  bool is_aligned() const { return normal.x == 0 && normal.y == 1 && normal.z == 0; }
  LevelPlaneSurface<Real> aligned() const { return {offset}; }
  template <class T>
  [[gnu::always_inline]] auto clear(const Vec3T<T>& x, T thickness) const {
    return dot(spread_out<T>(normal), x) >= T(offset) + thickness;
  }
  template <class T>
  [[gnu::always_inline]] Tangent<T> nearest(const Vec3T<T>&) const {
    return {spread_out<T>(normal), T(offset)};
  }
};

/// The sphere of a ball, or the sphere of a capsule that matters for a point or a path; one in
/// every lane.
template <class T>
struct SphereSurface {
  Vec3T<T> center;
  T radius;         ///< m
  Vec3T<T> beside;  ///< normal at the centre

  [[gnu::always_inline]] auto clear(const Vec3T<T>& x, T thickness) const {
    const T reach = radius + thickness;
    return squared_norm(x - center) >= reach * reach;
  }
  /// Farther away than reach plus path length, without the roots and with a margin for their
  /// rounding.
  [[gnu::always_inline]] auto beyond(const Vec3T<T>& x, T way2, T thickness) const {
    const T reach = radius + thickness, reach2 = reach * reach;
    const T more = squared_norm(x - center) - reach2 - way2;
    return more >= T(0) && more * more >= T(4.001) * reach2 * way2;
  }
  /// Whether both ends lie beyond the plane that touches the sphere towards `from`.
  [[gnu::always_inline]] auto misses(const Vec3T<T>& from, const Vec3T<T>& to) const {
    const Vec3T<T> a = from - center;
    const T aa = squared_norm(a), ab = dot(a, to - center);
    const T r2 = radius * radius;
    return aa > r2 && ab > T(0) && ab * ab > r2 * aa;
  }
  [[gnu::always_inline]] Tangent<T> nearest(const Vec3T<T>& x) const {
    const Vec3T<T> out = x - center;
    const T distance = norm(out);
    const auto apart = distance > T(0);
    return tangent_at(select(apart, out / select(apart, distance, T(1)), beside));
  }
  [[gnu::always_inline]] Entry<T> entry(const Vec3T<T>& from, const Vec3T<T>& to) const {
    using std::sqrt;
    const Vec3T<T> a = from - center, d = to - from;
    const T dd = squared_norm(d), ad = dot(a, d), above = squared_norm(a) - radius * radius;
    const auto inside = above <= T(0);
    const T discriminant = ad * ad - dd * above;
    const auto ahead = !inside && ad < T(0) && discriminant > T(0);
    const T root = sqrt(select(ahead, discriminant, T(1)));
    const T share = above / select(ahead, root - ad, T(1));  // the nearer root, no cancellation
    return {inside || (ahead && share <= T(1)),
            select(inside, nearest(from), tangent_at((a + share * d) / radius))};
  }

 private:
  [[gnu::always_inline]] Tangent<T> tangent_at(const Vec3T<T>& normal) const {
    return {normal, dot(normal, center) + radius};
  }
};

template <class Real>
struct BallSurface {
  using Shape = Ball;
  Vec3T<Real> center;
  Real radius;  ///< m

  template <class T>
  [[gnu::always_inline]] auto clear(const Vec3T<T>& x, T thickness) const {
    return sphere<T>().clear(x, thickness);
  }
  template <class T>
  [[gnu::always_inline]] auto beyond(const Vec3T<T>& x, T way2, T thickness) const {
    return sphere<T>().beyond(x, way2, thickness);
  }
  template <class T>
  [[gnu::always_inline]] auto misses(const Vec3T<T>& from, const Vec3T<T>& to) const {
    return sphere<T>().misses(from, to);
  }
  template <class T>
  [[gnu::always_inline]] Tangent<T> nearest(const Vec3T<T>& x) const {
    return sphere<T>().nearest(x);
  }
  template <class T>
  [[gnu::always_inline]] Entry<T> entry(const Vec3T<T>& from, const Vec3T<T>& to) const {
    return sphere<T>().entry(from, to);
  }

 private:
  template <class T>
  [[gnu::always_inline]] SphereSurface<T> sphere() const {
    return {spread_out<T>(center), T(radius), {T(0), T(1), T(0)}};
  }
};

/// A capsule: every point of its surface is on a sphere about a point of its axis.
template <class Real>
struct CapsuleSurface {
  using Shape = Capsule;
  Vec3T<Real> start, along;  ///< m, one end of the axis, and the vector to the other
  Real per_length2;          ///< 1/m^2, 1 / along . along; 0 if the axis has no length
  Real radius;               ///< m
  Vec3T<Real> beside;        ///< unit vector across the axis

  template <class T>
  [[gnu::always_inline]] auto clear(const Vec3T<T>& x, T thickness) const {
    return nearest_sphere(x).clear(x, thickness);
  }
  template <class T>
  [[gnu::always_inline]] auto beyond(const Vec3T<T>& x, T way2, T thickness) const {
    return nearest_sphere(x).beyond(x, way2, thickness);
  }
  /// Tests the sphere nearest to `from`: the plane that touches it there touches the whole capsule.
  template <class T>
  [[gnu::always_inline]] auto misses(const Vec3T<T>& from, const Vec3T<T>& to) const {
    return nearest_sphere(from).misses(from, to);
  }
  template <class T>
  [[gnu::always_inline]] Tangent<T> nearest(const Vec3T<T>& x) const {
    return nearest_sphere(x).nearest(x);
  }
  template <class T>
  [[gnu::always_inline]] Entry<T> entry(const Vec3T<T>& from, const Vec3T<T>& to) const {
    return entered_sphere(from, to).entry(from, to);
  }

 private:
  template <class T>
  [[gnu::always_inline]] T share_of(const Vec3T<T>& way) const {
    return dot(way, spread_out<T>(along)) * T(per_length2);
  }
  template <class T>
  [[gnu::always_inline]] SphereSurface<T> sphere_at(T share) const {
    return {spread_out<T>(start) + lesser(greater(share, T(0)), T(1)) * spread_out<T>(along),
            T(radius), spread_out<T>(beside)};
  }
  template <class T>
  [[gnu::always_inline]] SphereSurface<T> nearest_sphere(const Vec3T<T>& x) const {
    return sphere_at(share_of(x - spread_out<T>(start)));
  }
  /// The sphere through which a straight path enters. A path from outside the infinite cylinder
  /// about the axis first enters that cylinder. If it does so between the ends, it is there;
  /// otherwise it is at the end on that side, because on its way to the other end it would be
  /// inside. A path from within the cylinder can only enter at the end nearest to it.
  template <class T>
  [[gnu::always_inline]] SphereSurface<T> entered_sphere(const Vec3T<T>& from,
                                                         const Vec3T<T>& to) const {
    using std::sqrt;
    const Vec3T<T> a = from - spread_out<T>(start), d = to - from;
    const T a_share = share_of(a), d_share = share_of(d);
    const Vec3T<T> a_out = a - a_share * spread_out<T>(along),
                   d_out = d - d_share * spread_out<T>(along);
    const T dd = squared_norm(d_out), ad = dot(a_out, d_out);
    const T above = squared_norm(a_out) - T(radius * radius);
    const T discriminant = ad * ad - dd * above;
    const auto ahead = above > T(0) && ad < T(0) && discriminant > T(0);
    const T root = sqrt(select(ahead, discriminant, T(1)));
    const T enters = above / select(ahead, root - ad, T(1));
    return sphere_at(select(ahead, a_share + enters * d_share, a_share));
  }
};

template <class Real, bool along_axes>
struct AnyBoxSurface {
  using Shape = Box;
  Vec3T<Real> center, half;
  Vec3T<Real> axes[3];  ///< axes of the box in world coordinates
  Real far;             ///< m, from the centre to a corner

  bool is_aligned() const {
    for (int n = 0; n < 3; ++n)
      if (axes[n].x != (n == 0) || axes[n].y != (n == 1) || axes[n].z != (n == 2)) return false;
    return true;
  }
  AnyBoxSurface<Real, true> aligned() const {
    return {center, half, {axes[0], axes[1], axes[2]}, far};
  }

  template <class T>
  [[gnu::always_inline]] auto clear(const Vec3T<T>& x, T thickness) const {
    const Vec3T<T> out = x - spread_out<T>(center);
    const T reach = T(far) + thickness;
    return squared_norm(out) >= reach * reach || largest(excess(turned(out))) >= thickness;
  }
  /// clear(), and also true where x is over an edge or a corner, at least `thickness` away but less
  /// than that beyond each side.
  bool apart(const Vec3T<Real>& x, Real thickness) const {
    const Vec3T<Real> past = excess(local(x));
    const Vec3T<Real> out{greater(past.x, Real(0)), greater(past.y, Real(0)),
                          greater(past.z, Real(0))};
    return clear(x, thickness) || (largest(past) > 0 && squared_norm(out) >= thickness * thickness);
  }
  /// Farther beyond one side than the path is long.
  template <class T>
  [[gnu::always_inline]] auto beyond(const Vec3T<T>& x, T way2, T thickness) const {
    const T more = largest(excess(local(x))) - thickness;
    return more >= T(0) && more * more >= T(1.001) * way2;
  }
  /// Whether both ends lie beyond the same side.
  template <class T>
  [[gnu::always_inline]] auto misses(const Vec3T<T>& from, const Vec3T<T>& to) const {
    const Vec3T<T> a = local(from), b = local(to), h = spread_out<T>(half);
    const auto beside = [](T u, T v, T most) __attribute__((always_inline)) {
      return lesser(u, v) > most || greater(u, v) < T(0) - most;
    };
    return beside(a.x, b.x, h.x) || beside(a.y, b.y, h.y) || beside(a.z, b.z, h.z);
  }
  template <class T>
  [[gnu::always_inline]] Tangent<T> nearest(const Vec3T<T>& x) const {
    const Vec3T<T> at = local(x), past = excess(at);
    const T least = lesser(past.x, past.y), most = greater(past.x, past.y);
    const auto over_two = greater(least, lesser(most, past.z)) > T(0);  // the second largest
    Tangent<T> tangent = over_face(at, past);
    if (any(over_two)) tangent = select(over_two, over_corner(at), tangent);
    return tangent;
  }
  template <class T>
  [[gnu::always_inline]] Entry<T> entry(const Vec3T<T>& from, const Vec3T<T>& to) const {
    const Vec3T<T> a = local(from), d = turned(to - from);
    const auto inside = largest(excess(a)) <= T(0);
    // The path is inside the slab between two faces from `enters` to `leaves`. Where it runs along
    // them, it is inside for ever or never.
    constexpr Real kEver = std::numeric_limits<Real>::max();
    T in(-kEver), out(1);
    Tangent<T> side = face(0, T(1));
    const auto cut = [&](int axis, T ai, T di, T most) __attribute__((always_inline)) {
      const T toward = select(di > T(0), T(1), T(-1));
      const auto along = !(di > T(0)) && !(di < T(0));
      const auto between = magnitude(ai) < most;
      const T way = select(along, T(1), di);
      const T enters =
          select(along, select(between, T(-kEver), T(kEver)), (T(0) - toward * most - ai) / way);
      const T leaves = select(along, T(kEver), (toward * most - ai) / way);
      const auto later = enters > in;
      in = select(later, enters, in);
      side = select(later, face(axis, T(0) - toward), side);
      out = lesser(out, leaves);
    };
    cut(0, a.x, d.x, T(half.x));
    cut(1, a.y, d.y, T(half.y));
    cut(2, a.z, d.z, T(half.z));
    Tangent<T> tangent = side;
    if (any(inside)) tangent = select(inside, nearest(from), side);
    return {inside || (in >= T(0) && in < out), tangent};
  }

 private:
  template <class T>
  [[gnu::always_inline]] Vec3T<T> turned(const Vec3T<T>& v) const {
    if constexpr (along_axes) return v;
    return {dot(spread_out<T>(axes[0]), v), dot(spread_out<T>(axes[1]), v),
            dot(spread_out<T>(axes[2]), v)};
  }
  template <class T>
  [[gnu::always_inline]] Vec3T<T> local(const Vec3T<T>& x) const {
    return turned(x - spread_out<T>(center));
  }
  template <class T>
  [[gnu::always_inline]] Vec3T<T> world(const Vec3T<T>& v) const {
    if constexpr (along_axes) return v;
    const auto sum = [&v](Real a, Real b, Real c) __attribute__((always_inline)) {
      return dot(Vec3T<T>{T(a), T(b), T(c)}, v);
    };
    return {sum(axes[0].x, axes[1].x, axes[2].x), sum(axes[0].y, axes[1].y, axes[2].y),
            sum(axes[0].z, axes[1].z, axes[2].z)};
  }
  /// Distance beyond each pair of faces; negative between them.
  template <class T>
  [[gnu::always_inline]] Vec3T<T> excess(const Vec3T<T>& at) const {
    return {magnitude(at.x) - T(half.x), magnitude(at.y) - T(half.y), magnitude(at.z) - T(half.z)};
  }
  template <class T>
  [[gnu::always_inline]] static T largest(const Vec3T<T>& a) {
    return greater(greater(a.x, a.y), a.z);
  }
  template <class T>
  [[gnu::always_inline]] Tangent<T> face(int axis, T sign) const {
    const Real most[3] = {half.x, half.y, half.z}, middle[3] = {center.x, center.y, center.z};
    if constexpr (along_axes) {
      const T none(0);
      return {{axis == 0 ? sign : none, axis == 1 ? sign : none, axis == 2 ? sign : none},
              sign * T(middle[axis]) + T(most[axis])};
    }
    const Vec3T<T> normal = sign * spread_out<T>(axes[axis]);
    return {normal, dot(normal, spread_out<T>(center)) + T(most[axis])};
  }
  /// The half-space of the nearest face; from outside, over a single face, that face's.
  template <class T>
  [[gnu::always_inline]] Tangent<T> over_face(const Vec3T<T>& at, const Vec3T<T>& past) const {
    const auto sign = [](T v) __attribute__((always_inline)) {
      return select(v < T(0), T(-1), T(1));
    };
    const Tangent<T> xy = select(past.y > past.x, face(1, sign(at.y)), face(0, sign(at.x)));
    return select(past.z > greater(past.x, past.y), face(2, sign(at.z)), xy);
  }
  /// The half-space at the nearest point of an edge or corner, for a point outside.
  template <class T>
  [[gnu::always_inline]] Tangent<T> over_corner(const Vec3T<T>& at) const {
    const Vec3T<T> h = spread_out<T>(half);
    const Vec3T<T> corner{lesser(greater(at.x, T(0) - h.x), h.x),
                          lesser(greater(at.y, T(0) - h.y), h.y),
                          lesser(greater(at.z, T(0) - h.z), h.z)};
    const Vec3T<T> out = at - corner;
    const T distance = norm(out);
    const Vec3T<T> normal = world(out / select(distance > T(0), distance, T(1)));
    return {normal, dot(normal, spread_out<T>(center) + world(corner))};
  }
};

template <class Real>
using BoxSurface = AnyBoxSurface<Real, false>;
/// A box whose axes are the world's.
template <class Real>
using AlignedBoxSurface = AnyBoxSurface<Real, true>;

}  // namespace taut
