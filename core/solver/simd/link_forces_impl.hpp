#pragma once

// Included by kernels_impl.hpp, whose rules apply here, too; compiled once for each instruction
// set.

#include <cmath>
#include <cstring>
#include <type_traits>

#include "core/solver/simd/distance.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/lanes.hpp"

namespace taut {

/// Length with kTinyLength, as in distance.hpp: a link of length 0 does not pull.
template <class T>
[[gnu::always_inline]] inline T length_of(const Vec3T<T>& way) {
  using std::sqrt;
  return sqrt(squared_norm(way) + T(kTinyLength * kTinyLength));
}

/// Force of lanes l, l + 1, .. of a slot on its vertices [N]; way: from there to the other end.
/// Both ends of a link compute the same bits of the force and of the values that they keep.
///
///     k (n - r) u
template <class T, class Real>
[[gnu::always_inline]] inline Vec3T<T> link_force(SpringSlot<Real>& slot, int l,
                                                  const Vec3T<T>& way) {
  const T length = length_of(way), beyond = length - load<T>(slot.rest + l);
  return load<T>(slot.stiffness + l) * beyond / length * way;
}

/// Force of a link with a multiplier, as in admm.cpp; the multiplier becomes u'. z is eliminated:
///
///     p = d + u,   u' = p - z = (|p| - r)/(1 + k/K) p/|p|,   k (d - (z - u')) = k (2 u' - u)
template <class T, class Real>
[[gnu::always_inline]] inline Vec3T<T> link_force(MultiplierSlot<Real>& slot, int l,
                                                  const Vec3T<T>& way) {
  const Vec3T<T> u{load<T>(slot.multiplier[0] + l), load<T>(slot.multiplier[1] + l),
                   load<T>(slot.multiplier[2] + l)};
  const Vec3T<T> p = way + u;
  const T length = length_of(p), beyond = length - load<T>(slot.rest + l);
  const Vec3T<T> next = load<T>(slot.share + l) * beyond / length * p;
  store(slot.multiplier[0] + l, next.x);
  store(slot.multiplier[1] + l, next.y);
  store(slot.multiplier[2] + l, next.z);
  return load<T>(slot.stiffness + l) * (next + next - u);
}

/// Sum of the forces of all links in lanes l, l + 1, .. of group g at x, in the order of their
/// slots.
template <class T, class Slot, class Real>
[[gnu::always_inline]] inline Vec3T<T> force_of_links(const VertexGroup& group, Slot* slots, int l,
                                                      const Real* x, const Vec3T<T>& at) {
  Vec3T<T> sum{T(0), T(0), T(0)};
  for (std::uint32_t s = group.first_slot; s < group.end_slot; ++s)
    sum = sum + link_force(slots[s], l, gather_packed<T>(x, slots[s].other + l) - at);
  return sum;
}

/// Stores x y z 0 of the packed particles in lanes l, l + 1, .. in double.
template <class T, class Real>
[[gnu::always_inline]] inline void store_rows(double* rows, const PackedSlot* at,
                                              const Vec3T<T>& to) {
  if constexpr (std::is_same_v<Real, double>) {
    scatter_packed(rows, at, to);
  } else if constexpr (kWidth<T> == 1) {
    double* const row = particle(rows, *at);
    row[0] = static_cast<double>(to.x);
    row[1] = static_cast<double>(to.y);
    row[2] = static_cast<double>(to.z);
  } else {
    using Four [[gnu::vector_size(4 * sizeof(double))]] = double;
    T p[4];
    transpose(to, p);
    const auto put = [&](int l, const auto& xyz) __attribute__((always_inline)) {
      const Four wide = __builtin_convertvector(xyz, Four);
      std::memcpy(particle(rows, at[l]), &wide, sizeof wide);
    };
    four_times([&](auto l) __attribute__((always_inline)) {
      if constexpr (kWidth<T> == 4) {
        put(l, p[l].v);
      } else {
        put(l, p[l].lower());
        put(l + 4, p[l].upper());
      }
    });
  }
}

/// Minus the gradient of inertia and links.
template <class T, class Slot, class Real>
void forces(const ForceSweep<Real>& sweep, Slot* slots, std::size_t begin, std::size_t end) {
  const ForceSweep<Real> v = sweep;  // a copy, which no store changes
  for (std::size_t g = begin; g < end; ++g)
    for (int l = 0; l < kLanes; l += kWidth<T>) {
      const VertexGroup& group = v.groups[g];
      const PackedSlot* const at = group.particle + l;
      const Vec3T<T> x = gather_packed<T>(v.x, at);
      const Vec3T<T> way = gather_packed<T>(v.y, at) - x;
      const Vec3T<T> links = force_of_links<T>(group, slots, l, v.x, x);
      store_rows<T, Real>(v.rows, at, links + load<T>(v.inertia + kLanes * g + l) * way);
    }
}

/// a += w (links - drag (x - x_previous)).
template <class T, class Real>
void accelerate(const AccelerationSweep<Real>& sweep, SpringSlot<Real>* slots, std::size_t begin,
                std::size_t end) {
  const AccelerationSweep<Real> v = sweep;
  const T drag(v.drag);
  for (std::size_t g = begin; g < end; ++g)
    for (int l = 0; l < kLanes; l += kWidth<T>) {
      const VertexGroup& group = v.groups[g];
      const PackedSlot* const at = group.particle + l;
      const Vec3T<T> x = gather_packed<T>(v.x, at);
      Vec3T<T> force = force_of_links<T>(group, slots, l, v.x, x);
      if (v.drag != 0) force = force - drag * (x - gather_packed<T>(v.previous, at));
      const Vec3T<T> a = gather_packed<T>(v.a, at);
      scatter_packed(v.a, at, a + load<T>(v.w + kLanes * g + l) * force);
    }
}

}  // namespace taut
