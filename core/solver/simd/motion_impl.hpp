#pragma once

// Included by kernels_impl.hpp, whose rules apply here, too; compiled once for each instruction
// set.

#include <cstddef>
#include <cstring>

#include "core/solver/simd/collide_impl.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/lanes.hpp"

namespace taut {

/// Folds the lanes of `all` with f, one after another.
template <class T, class Real, class F>
[[gnu::always_inline]] inline Real over_lanes(const T& all, const F& f) {
  Real numbers[kWidth<T>];
  std::memcpy(numbers, &all, sizeof numbers);
  Real result = numbers[0];
  for (int l = 1; l < kWidth<T>; ++l) result = f(result, numbers[l]);
  return result;
}

/// Bounds of the motion of packed particles, read as they lie there (x y z 0 after x y z 0), in
/// vectors of whole particles.
template <class T, class Real>
MotionBox<Real> packed_motion_box(const ParticleSpan<Real>& span, const Real* then,
                                  std::size_t begin, std::size_t end) {
  const Real* const x = span.x;
  const std::size_t last = 4 * span.particles - kWidth<T>;  // reading one twice changes nothing
  const std::size_t part_end = 4 * kLanes * end;
  T least = load<T>(x) - load<T>(then), most = least;
  for (std::size_t i = 4 * kLanes * begin; i < part_end && i < last + kWidth<T>; i += kWidth<T>) {
    const std::size_t at = i < last ? i : last;
    const T moved = load<T>(x + at) - load<T>(then + at);
    least = lesser(least, moved);
    most = greater(most, moved);
  }
  Real low[kWidth<T>], high[kWidth<T>];
  std::memcpy(low, &least, sizeof low);
  std::memcpy(high, &most, sizeof high);
  for (int l = 4; l < kWidth<T>; ++l) {
    low[l % 4] = lesser(low[l % 4], low[l]);
    high[l % 4] = greater(high[l % 4], high[l]);
  }
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

template <class Narrow, class Wide, class P, class Real>
MotionBoxes<Real> motion_boxes(const ParticleSpan<Real>& span, const Real* then, std::size_t begin,
                               std::size_t end) {
  if constexpr (kWidth<P> >= 4)
    if (span.sheet.lanes == kPackedLanes && 4 * span.particles >= kWidth<P>)
      return {packed_motion_box<P>(span, span.previous, begin, end),
              packed_motion_box<P>(span, then, begin, end)};
  MotionBoxes<Real> boxes{};
  with_lanes<Narrow, Wide, P>(
      span, [&](auto t, auto of_layout) __attribute__((always_inline)) {
        using T = decltype(t);
        constexpr int lanes = of_layout;
        const auto first = [&](const Real* from) __attribute__((always_inline)) {
          const auto moved = [&](int axis) { return T(span.x[axis * lanes] - from[axis * lanes]); };
          return Vec3T<T>{moved(0), moved(1), moved(2)};
        };
        const Vec3T<T> starts[2] = {first(span.previous), first(then)};
        Vec3T<T> least[2] = {starts[0], starts[1]}, most[2] = {starts[0], starts[1]};
        const auto one = [&](std::size_t at, const auto& present) __attribute__((always_inline)) {
          const Vec3T<T> x = load_vec3<T, lanes>(span.x + at);
          const auto add = [&](int k, const Real* from) __attribute__((always_inline)) {
            const Vec3T<T> m = select(present, x - load_vec3<T, lanes>(from + at), starts[k]);
            least[k] = {lesser(least[k].x, m.x), lesser(least[k].y, m.y), lesser(least[k].z, m.z)};
            most[k] = {greater(most[k].x, m.x), greater(most[k].y, m.y), greater(most[k].z, m.z)};
          };
          add(0, span.previous);
          add(1, then);
        };
        visit_particles<T, lanes>(span, begin, end, one);
        const auto low = [](const T& all) { return over_lanes<T, Real>(all, lesser<Real>); };
        const auto high = [](const T& all) { return over_lanes<T, Real>(all, greater<Real>); };
        const auto box = [&](int k) -> MotionBox<Real> {
          return {{low(least[k].x), low(least[k].y), low(least[k].z)},
                  {high(most[k].x), high(most[k].y), high(most[k].z)}};
        };
        boxes = {box(0), box(1)};
      });
  return boxes;
}

template <class Narrow, class Wide, class P, class Real>
Real largest_motion2(const ParticleSpan<Real>& span, const Vec3T<Real>& middle, std::size_t begin,
                     std::size_t end) {
  Real largest = 0;
  with_lanes<Narrow, Wide, P>(
      span, [&](auto t, auto of_layout) __attribute__((always_inline)) {
        using T = decltype(t);
        constexpr int lanes = of_layout;
        T most(0);
        const auto one = [&](std::size_t at, const auto& present) __attribute__((always_inline)) {
          const Vec3T<T> moved =
              load_vec3<T, lanes>(span.x + at) - load_vec3<T, lanes>(span.previous + at);
          most = greater(most, select(present, squared_norm(moved - spread_out<T>(middle)), T(0)));
        };
        visit_particles<T, lanes>(span, begin, end, one);
        largest = over_lanes<T, Real>(most, greater<Real>);
      });
  return largest;
}

}  // namespace taut
