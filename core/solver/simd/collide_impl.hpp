#pragma once

// Included by kernels_impl.hpp, whose rules apply here, too; compiled once for each instruction
// set.

#include <cstdint>
#include <type_traits>

#include "core/solver/simd/kernels.hpp"
#include "core/solver/simd/lanes.hpp"

namespace taut {

template <class Real>
inline constexpr Real kNumbers[kWide] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

/// Which of the lanes, numbered from `first` on, are below `end`.
template <class T, class Real>
[[gnu::always_inline]] inline auto lanes_below(int first, Real end) {
  return load<T>(kNumbers<Real> + first) < T(end);
}

/// Calls f(place, present) for the particles of the parts [begin, end), kWidth<T> at a time;
/// `present` excludes padding.
template <class T, int lanes, class Real, class F>
[[gnu::always_inline]] inline void visit_particles(const ParticleSpan<Real> span, std::size_t begin,
                                                   std::size_t end, const F& f) {
  if constexpr (lanes == kPackedLanes) {
    for (std::size_t i = begin * kLanes; i < end * kLanes; i += kWidth<T>)
      f(4 * i, lanes_below<T>(0, static_cast<Real>(span.particles) - static_cast<Real>(i)));
  } else {
    // The first vectors of a row have a column in one lane more than the others.
    const SheetRows& sheet = span.sheet;
    const int others = (sheet.columns - 1) / sheet.vectors;
    const int first = sheet.columns - others * sheet.vectors;
    const Real columns[2] = {static_cast<Real>(others), static_cast<Real>(others + 1)};
    for (std::size_t row = begin; row < end; ++row)
      for (int k = 0; k < sheet.vectors; ++k)
        for (int l = 0; l < lanes; l += kWidth<T>)
          f(row * sheet.stride + static_cast<std::size_t>(3 * lanes * k + l),
            lanes_below<T>(l, columns[k < first]));
  }
}

/// Calls f with a lane type and, as a constant, the number of lanes of the span's layout.
template <class Narrow, class Wide, class P, class Real, class F>
[[gnu::always_inline]] inline void with_lanes(const ParticleSpan<Real>& span, const F& f) {
  if (span.sheet.lanes == kWide)
    f(Wide(0), std::integral_constant<int, kWide>{});
  else if (span.sheet.lanes == kNarrow)
    f(Narrow(0), std::integral_constant<int, kNarrow>{});
  else
    f(P(0), std::integral_constant<int, kPackedLanes>{});
}

/// Moves those of kWidth<T> particles that are `near` out of the collider. Returns whether any was
/// inside.
template <bool continuous, class T, class C, class Mask>
[[gnu::always_inline]] inline bool project_near(const C& contact, Vec3T<T>& x,
                                                const Vec3T<T>& previous, const Mask& near) {
  if constexpr (continuous)
    return any(contact.project_continuous(x, previous, near));
  else
    return any(contact.project(x, previous, near));
}

/// For every mask of eight lanes, the numbers of the lanes in it, one after another; or, with
/// `back`, the position of each lane among these. Other entries are 0.
struct LaneOrders {
  std::uint8_t of[256][8] = {};
  explicit consteval LaneOrders(bool back) {
    for (unsigned mask = 0; mask < 256; ++mask)
      for (std::uint8_t lane = 0, place = 0; lane < 8; ++lane)
        if ((mask >> lane & 1) != 0) {
          of[mask][back ? lane : place] = back ? place : lane;
          ++place;
        }
  }
};
inline constexpr LaneOrders kGather(false), kSpread(true);

/// Collects from many vectors the particles that may touch, side by side. On a ball, two lanes of
/// eight do on average, and the roots and divisions of the others would be wasted.
template <class T, int lanes, class Real>
class NearParticles {
 public:
  /// Adds the `near` particles of the vector at `place`.
  [[gnu::always_inline]] void add(std::size_t place, const typename T::Mask& near,
                                  const Vec3T<T>& x, const Vec3T<T>& previous) {
    const unsigned mask = bits(near);
    const auto index = T::indices(kGather.of[mask]);
    origins_[vectors_++] = {near, place, count_, mask};
    Real* const to = numbers_ + count_;
    const T all[kArrays] = {x.x, x.y, x.z, previous.x, previous.y, previous.z};
#pragma GCC unroll 6
    for (std::size_t n = 0; n < kArrays; ++n) store(to + n * kLength, all[n].permuted(index));
    count_ += static_cast<std::size_t>(__builtin_popcount(mask));
  }
  bool full() const { return vectors_ == kVectors; }

  /// Moves the collected particles out of the collider, and forgets them.
  template <bool continuous, class C>
  [[gnu::noinline]] void project(const C& contact_in, Real* x) {
    const C contact = contact_in;  // a copy, which no store changes
    for (std::size_t n = 0; n < kArrays; ++n) store(numbers_ + n * kLength + count_, T(0));
    for (std::size_t i = 0; i < count_; i += kWidth<T>) {
      Vec3T<T> p = numbers(0, i);
      const auto present = lanes_below<T>(0, static_cast<Real>(count_ - i));
      project_near<continuous>(contact, p, numbers(3, i), present);
      store(numbers_ + i, p.x);
      store(numbers_ + kLength + i, p.y);
      store(numbers_ + 2 * kLength + i, p.z);
    }
    for (std::size_t v = 0; v < vectors_; ++v) {
      const Origin& origin = origins_[v];
      const auto index = T::indices(kSpread.of[origin.bits]);
      const Vec3T<T> p = numbers(0, origin.first);
      const Vec3T<T> moved{p.x.permuted(index), p.y.permuted(index), p.z.permuted(index)};
      Real* const to = x + origin.place;
      store_vec3<T, lanes>(to, select(origin.near, moved, load_vec3<T, lanes>(to)));
    }
    vectors_ = count_ = 0;
  }

 private:
  static constexpr std::size_t kVectors = 32, kLength = kWidth<T> * (kVectors + 1), kArrays = 6;
  struct Origin {
    typename T::Mask near;
    std::size_t place, first;
    unsigned bits;
  };

  [[gnu::always_inline]] Vec3T<T> numbers(std::size_t array, std::size_t i) const {
    const Real* const from = numbers_ + array * kLength + i;
    return {load<T>(from), load<T>(from + kLength), load<T>(from + 2 * kLength)};
  }

  alignas(64) Real numbers_[kArrays * kLength];  ///< x, y, z of each, then of `previous`
  Origin origins_[kVectors];
  std::size_t vectors_ = 0, count_ = 0;
};

/// Whether typically only some lanes touch. A cloth lies on a plane with nearly all of its lanes,
/// and there is little to compute: putting near ones side by side would not pay.
template <template <class> class SurfaceOf>
inline constexpr bool kTouchesSomeLanes = true;
template <>
inline constexpr bool kTouchesSomeLanes<PlaneSurface> = false;
template <>
inline constexpr bool kTouchesSomeLanes<LevelPlaneSurface> = false;

template <class Narrow, class Wide, class P, bool continuous, class Real,
          template <class> class SurfaceOf>
void collide(const Contact<Real, SurfaceOf>& contact_in, const ParticleSpan<Real>& span_in,
             std::size_t begin, std::size_t end) {
  const Contact<Real, SurfaceOf> contact = contact_in;  // copies, which no store changes
  const ParticleSpan<Real> span = span_in;
  with_lanes<Narrow, Wide, P>(
      span, [&](auto t, auto of_layout) __attribute__((always_inline)) {
        using T = decltype(t);
        constexpr int lanes = of_layout;
        constexpr bool some_lanes = kPermutes<T> && kTouchesSomeLanes<SurfaceOf>;
        [[maybe_unused]] std::conditional_t<some_lanes, NearParticles<T, lanes, Real>, int> found;
        const auto one = [&](std::size_t at, const auto& present) __attribute__((always_inline)) {
          Vec3T<T> x = load_vec3<T, lanes>(span.x + at);
          const Vec3T<T> previous = load_vec3<T, lanes>(span.previous + at);
          const auto near = present && contact.template near<continuous>(x, previous);
          if (!any(near)) return;
          if constexpr (some_lanes) {
            found.add(at, near, x, previous);
            if (found.full()) found.template project<continuous>(contact, span.x);
          } else if (project_near<continuous>(contact, x, previous, near)) {
            store_vec3<T, lanes>(span.x + at, x);
          }
        };
        visit_particles<T, lanes>(span, begin, end, one);
        if constexpr (some_lanes) found.template project<continuous>(contact, span.x);
      });
}

/// Same numbers as collide(), but for a surface along the world's axes the loop leaves out what it
/// does not need.
template <class Narrow, class Wide, class P, bool continuous, class Real,
          template <class> class SurfaceOf, template <class> class AlignedOf>
void collide_aligned_or_not(const Contact<Real, SurfaceOf>& contact, const ParticleSpan<Real>& span,
                            std::size_t begin, std::size_t end) {
  if (contact.surface.is_aligned())
    collide<Narrow, Wide, P, continuous, Real, AlignedOf>(
        {contact.surface.aligned(), contact.motion, contact.thickness, contact.friction}, span,
        begin, end);
  else
    collide<Narrow, Wide, P, continuous, Real, SurfaceOf>(contact, span, begin, end);
}

}  // namespace taut
