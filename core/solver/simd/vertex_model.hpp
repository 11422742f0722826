#pragma once

#include "core/solver/simd/distance.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/lanes.hpp"

namespace taut {

template <class T>
[[gnu::always_inline]] inline T not_negative(T a) {
  return select(a > T(0), a, T(0));
}

/// Energy of one vertex, with all others held, to second order around its position: the force on it
/// and its Hessian, for every width and precision.
template <class T>
struct VertexModel {
  Vec3T<T> force{T(0), T(0), T(0)};                                    ///< N
  T xx = T(0), yy = T(0), zz = T(0), xy = T(0), xz = T(0), yz = T(0);  ///< N/m
  T isotropic = T(0);  ///< N/m, adds to H that number times I

  /// Adds s u u^T.
  [[gnu::always_inline]] void add_along(T s, const Vec3T<T>& u) {
    const Vec3T<T> su = s * u;
    xx += su.x * u.x;
    yy += su.y * u.y;
    zz += su.z * u.z;
    xy += su.x * u.y;
    xz += su.x * u.z;
    yz += su.y * u.z;
  }
  /// Adds `isotropic` to the diagonal. Call it before anything that reads the whole Hessian.
  [[gnu::always_inline]] void fold() {
    xx += isotropic;
    yy += isotropic;
    zz += isotropic;
    isotropic = T(0);
  }
  [[gnu::always_inline]] void scale_hessian(T s) {
    xx = s * xx;
    yy = s * yy;
    zz = s * zz;
    xy = s * xy;
    xz = s * xz;
    yz = s * yz;
  }
  [[gnu::always_inline]] Vec3T<T> hessian_times(const Vec3T<T>& v) const {
    return {xx * v.x + (xy * v.y + xz * v.z), xy * v.x + (yy * v.y + yz * v.z),
            xz * v.x + (yz * v.y + zz * v.z)};
  }
  /// Stores xx, yy, zz, xy, xz, yz, kLanes apart.
  template <class Real>
  [[gnu::always_inline]] void store_hessian(Real* to) const {
    store(to, xx);
    store(to + kLanes, yy);
    store(to + 2 * kLanes, zz);
    store(to + 3 * kLanes, xy);
    store(to + 4 * kLanes, xz);
    store(to + 5 * kLanes, yz);
  }
  /// H^-1 force by L D L^T. H is `least` times I plus something positive, so no element of D is
  /// less than `least`, except by rounding where links are a million times as stiff.
  [[gnu::always_inline]] Vec3T<T> minimum(T least) const {
    const T one(1), inverse_x = one / xx, lxy = xy * inverse_x, lxz = xz * inverse_x;
    const T inverse_y = one / greater(yy - lxy * xy, least);
    const T rest_yz = yz - lxy * xz, lyz = rest_yz * inverse_y;
    const T dz = greater(zz - lxz * xz - lyz * rest_yz, least);
    const T fy = force.y - lxy * force.x, fz = force.z - lxz * force.x - lyz * fy;
    const T z = fz / dz, y = fy * inverse_y - lyz * z;
    return {force.x * inverse_x - lxy * y - lxz * z, y, z};
  }
};

/// A link seen from one end. With kTinyLength, as in distance.hpp, a link of length 0 has the
/// direction 0: it neither pulls nor stiffens.
template <class T>
struct LinkWay {
  T length, inverse;  ///< m, 1/m
  Vec3T<T> u;         ///< towards the other end
};
template <class T>
[[gnu::always_inline]] inline LinkWay<T> link_way(const Vec3T<T>& way) {
  using std::sqrt;
  const T length = sqrt(squared_norm(way) + T(kTinyLength * kTinyLength)), inverse = T(1) / length;
  return {length, inverse, inverse * way};
}

/// Adds the links in lanes l, l + 1, .. of a slot; way: from the vertex to the link's other end.
///
///     f += K C u,   H += K [ u u^T + max(0, C/n) (I - u u^T) ]
template <class T, class Real>
[[gnu::always_inline]] inline void add_link(VertexModel<T>& m, const SpringSlot<Real>& slot, int l,
                                            const Vec3T<T>& way) {
  const LinkWay<T> link = link_way(way);
  const T k = load<T>(slot.stiffness + l), pull = k * (link.length - load<T>(slot.rest + l));
  const T across = not_negative(pull * link.inverse);
  m.force = m.force + pull * link.u;
  m.add_along(k - across, link.u);
  m.isotropic += across;
}

/// Norm of a column of the projection I - u u^T, whose entry of u is c: sqrt(1 - c^2).
template <class T>
[[gnu::always_inline]] inline T column_norm(T c) {
  using std::sqrt;
  return sqrt(not_negative(T(1) - c * c));
}

/// Adds links with a multiplier:
///
///     F = k (C - alpha C_0) + l,   f += F u,   H += k u u^T + diag |columns of F (I - u u^T)/n|
template <class T, class Real>
[[gnu::always_inline]] inline void add_link(VertexModel<T>& m, const AugmentedSlot<Real>& slot,
                                            int l, const Vec3T<T>& way) {
  const LinkWay<T> link = link_way(way);
  const T k = load<T>(slot.stiffness + l);
  const T pull = k * (link.length - load<T>(slot.rest + l) - load<T>(slot.left + l)) +
                 load<T>(slot.multiplier + l);
  const T turn = select(squared_norm(link.u) > T(0), magnitude(pull) * link.inverse, T(0));
  m.force = m.force + pull * link.u;
  m.add_along(k, link.u);
  m.xx += turn * column_norm(link.u.x);
  m.yy += turn * column_norm(link.u.y);
  m.zz += turn * column_norm(link.u.z);
}

/// Model of the vertices in lanes l, l + 1, .. of group g at x. Links are added in the order of
/// their slots, so that every width gives the same bits.
template <class T, class Slot, class Real>
[[gnu::always_inline]] inline VertexModel<T> vertex_model(const VertexSweep<Real>& v,
                                                          const Slot* slots, std::size_t g, int l,
                                                          const Vec3T<T>& x) {
  const VertexGroup& group = v.groups[g];
  VertexModel<T> m;
  for (std::uint32_t s = group.first_slot; s < group.end_slot; ++s)
    add_link(m, slots[s], l, gather_packed<T>(v.x, slots[s].other + l) - x);
  if (v.damping > 0) {  // as published: by each vertex' own displacement
    m.fold();
    const T damping(v.damping);
    const Vec3T<T> way = x - gather_packed<T>(v.previous, group.particle + l);
    m.force = m.force - damping * m.hessian_times(way);
    m.scale_hessian(T(1) + damping);
  }
  if (v.bending) {
    const Real* const bending = v.bending + 4 * kLanes * g + l;
    m.force = m.force +
              Vec3T<T>{load<T>(bending), load<T>(bending + kLanes), load<T>(bending + 2 * kLanes)};
    m.isotropic += load<T>(bending + 3 * kLanes);
  }
  if (v.membrane) {
    const Real* const row = v.membrane + 9 * kLanes * g + l;
    m.force = m.force + Vec3T<T>{load<T>(row), load<T>(row + kLanes), load<T>(row + 2 * kLanes)};
    m.xx += load<T>(row + 3 * kLanes);
    m.yy += load<T>(row + 4 * kLanes);
    m.zz += load<T>(row + 5 * kLanes);
    m.xy += load<T>(row + 6 * kLanes);
    m.xz += load<T>(row + 7 * kLanes);
    m.yz += load<T>(row + 8 * kLanes);
  }
  const T inertia = load<T>(v.inertia + kLanes * g + l);
  m.force = m.force - inertia * (x - gather_packed<T>(v.y, group.particle + l));
  m.isotropic += inertia;
  m.fold();
  return m;
}

}  // namespace taut
