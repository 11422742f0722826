#pragma once

// Included by instruction_set.cpp, which is compiled once for each instruction set and defines its
// lanes. No function here may be shared between instruction sets: everything depends on the lane
// type, which is private to that file.

#include <cstring>
#include <type_traits>

#include "core/solver/simd/batches_impl.hpp"
#include "core/solver/simd/collide_impl.hpp"
#include "core/solver/simd/distance.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/lanes.hpp"
#include "core/solver/simd/link_forces_impl.hpp"
#include "core/solver/simd/motion_impl.hpp"
#include "core/solver/simd/neighbour_search_impl.hpp"
#include "core/solver/simd/panels_impl.hpp"
#include "core/solver/simd/sheet_impl.hpp"
#include "core/solver/simd/vertex_sweep_impl.hpp"
#include "core/solver/simd/wind_impl.hpp"

namespace taut {

/// s is a copy, whose members no store can change.
template <class T, bool forces, class Real>
[[gnu::always_inline]] inline void integrate(const VerletStep<Real> s, std::size_t begin,
                                             std::size_t end) {
  const T keep(s.keep), dt2(s.dt2);
  for (std::size_t i = begin; i < end; i += kGrain)
#pragma GCC unroll 12
    for (std::size_t l = 0; l < kGrain; l += kWidth<T>) {
      const T x = load<T>(s.x + i + l);
      T moved = x + (keep * (x - load<T>(s.previous + i + l)) + load<T>(s.g + l));
      if constexpr (forces) {
        moved = moved + load<T>(s.a + i + l) * dt2;
        store(s.a + i + l, T(0.0));
      }
      store(s.x + i + l, moved);
      store(s.previous + i + l, x);
    }
}
template <class T, class Real>
void verlet(const VerletStep<Real>& s, std::size_t begin, std::size_t end) {
  s.a ? integrate<T, true>(s, begin, end) : integrate<T, false>(s, begin, end);
}

template <class Narrow, class Wide, class P, Projection kind, class Real>
void tethers(const ParticleSpan<Real>& span_in, std::span<const TetherTable<Real>> tables) {
  const ParticleSpan<Real> span = span_in;  // a copy, which no store changes
  with_lanes<Narrow, Wide, P>(
      span, [&](auto t, auto of_layout) __attribute__((always_inline)) {
        using T = decltype(t);
        constexpr int lanes = of_layout;
        // Table after table: a particle's second tether waits for its first, and other particles
        // fill the time. Packed particles would have to be transposed for each table.
        const std::size_t at_once = lanes == kPackedLanes ? tables.size() : 1;
        std::span<const TetherTable<Real>> some;
        const auto one = [&](std::size_t at, const auto&) __attribute__((always_inline)) {
          Vec3T<T> x = load_vec3<T, lanes>(span.x + at);
          bool moved = false;
          for (const TetherTable<Real>& table : some) {
            Vec3T<T> pin = load_vec3<T, lanes>(table.pin + at), end = x;
            const T length = load_vec3<T, lanes>(table.length + at).x;
            const Vec3T<T> way = end - pin;  // summed as in project_distance: computed only once
            const auto tight = way.x * way.x + way.y * way.y + way.z * way.z > length * length;
            if (!any(tight)) continue;
            project_distance<kind>(pin, end, length, T(0), T(1));
            x = select(tight, end, x);
            moved = true;
          }
          if (moved) store_vec3<T, lanes>(span.x + at, x);
        };
        for (std::size_t n = 0; n < tables.size(); n += at_once) {
          some = tables.subspan(n, at_once);
          visit_particles<T, lanes>(span, 0, span.parts(), one);
        }
      });
}

template <class T, Projection kind, class Real>
Real in_registers(Real rest, int rounds, int& projections) {
  constexpr int pairs = 4;
  const T r(rest), half(0.5);
  Vec3T<T> a[pairs], b[pairs];
  four_times([&](auto i) {
    const T start(static_cast<Real>(i));
    a[i] = {start, start, start};
    b[i] = {start + r, start + r, start};
  });
  for (int n = 0; n < rounds; ++n)
    four_times([&](auto i) { project_distance<kind>(a[i], b[i], r, half, half); });
  projections = pairs * rounds * kWidth<T>;
  T sum(0.0);
  four_times([&](auto i) { sum += a[i].x + b[i].y; });
  Real first;
  std::memcpy(&first, &sum, sizeof first);
  return first;
}

/// Narrow and Wide compute on interleaved sheets of 8 and 16 lanes, P on packed particles, and all
/// three in contact. Double computes on matrices.
template <class Real, class Narrow, class Wide, class P, class Double>
constexpr Kernels<Real> make_kernels() {
  constexpr Projection exact = Projection::exact, sqrt_free = Projection::sqrt_free;
  return {
      .narrow_verlet = verlet<Narrow, Real>,
      .wide_verlet = verlet<Wide, Real>,
      .narrow_sheet = {sweep_sheet<Narrow, kNarrow, exact, Real>,
                       sweep_sheet<Narrow, kNarrow, sqrt_free, Real>},
      .wide_sheet = {sweep_sheet<Wide, kWide, exact, Real>,
                     sweep_sheet<Wide, kWide, sqrt_free, Real>},
      .batches = {batches<P, exact, Real>, batches<P, sqrt_free, Real>},
      .compliant_narrow_sheet = sweep_compliant_sheet<Narrow, kNarrow, Real>,
      .compliant_wide_sheet = sweep_compliant_sheet<Wide, kWide, Real>,
      .compliant_batches = compliant_batches<P, Real>,
      .collide =
          {.plane = collide_aligned_or_not<Narrow, Wide, P, false, Real, PlaneSurface,
                                           LevelPlaneSurface>,
           .ball = collide<Narrow, Wide, P, false, Real, BallSurface>,
           .ball_continuous = collide<Narrow, Wide, P, true, Real, BallSurface>,
           .box =
               collide_aligned_or_not<Narrow, Wide, P, false, Real, BoxSurface, AlignedBoxSurface>,
           .box_continuous =
               collide_aligned_or_not<Narrow, Wide, P, true, Real, BoxSurface, AlignedBoxSurface>,
           .capsule = collide<Narrow, Wide, P, false, Real, CapsuleSurface>,
           .capsule_continuous = collide<Narrow, Wide, P, true, Real, CapsuleSurface>},
      .narrow_wind = wind_on_sheet<Narrow, kNarrow, Real>,
      .wide_wind = wind_on_sheet<Wide, kWide, Real>,
      .wind_on_faces = wind_on_faces<P, Real>,
      .sweep_springs = sweep_vertices<P, SpringSlot<Real>, Real>,
      .sweep_augmented = sweep_vertices<P, AugmentedSlot<Real>, Real>,
      .begin_augmented = begin_augmented<P, Real>,
      .augment = augment<P, Real>,
      .spring_forces = forces<P, SpringSlot<Real>, Real>,
      .multiplier_forces = forces<P, MultiplierSlot<Real>, Real>,
      .accelerate = accelerate<P, Real>,
      .eliminate = eliminate<Double>,
      .solve_panels = solve_panels<Double>,
      .tethers = {tethers<Narrow, Wide, P, exact, Real>, tethers<Narrow, Wide, P, sqrt_free, Real>},
      .motion_boxes = motion_boxes<Narrow, Wide, P, Real>,
      .largest_motion2 = largest_motion2<Narrow, Wide, P, Real>,
      .find_pairs = find_pairs<Narrow, Real>,
      .in_registers = in_registers<Wide, sqrt_free, Real>,
      .load_and_store = load_and_store<P, Real>};
}

}  // namespace taut
