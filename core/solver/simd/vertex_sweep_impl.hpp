#pragma once

// Included by kernels_impl.hpp, whose rules apply here, too; compiled once for each instruction
// set.

#include "core/solver/simd/vertex_model.hpp"

namespace taut {

template <class T, class Slot, class Real>
void sweep_vertices(const VertexSweep<Real>& sweep, const Slot* slots, std::size_t begin,
                    std::size_t end) {
  const VertexSweep<Real> v = sweep;  // a copy, whose members no store can change
  for (std::size_t g = begin; g < end; ++g)
    for (int l = 0; l < kLanes; l += kWidth<T>) {
      const PackedSlot* const at = v.groups[g].particle + l;
      const Vec3T<T> x = gather_packed<T>(v.x, at);
      VertexModel<T> m = vertex_model<T>(v, slots, g, l, x);
      if (v.held) {
        const Real* const held = v.held + 3 * kLanes * g + l;
        m.force =
            m.force + Vec3T<T>{load<T>(held), load<T>(held + kLanes), load<T>(held + 2 * kLanes)};
      }
      if (v.hessian) m.store_hessian(v.hessian + 6 * kLanes * g + l);
      scatter_packed(v.x, at, x + m.minimum(load<T>(v.inertia + kLanes * g + l)));
    }
}

/// Calls f(slot, l, length) for lanes l, l + 1, .. of every slot of groups [begin, end). `length`
/// has the lengths of these links at `x`.
template <class T, class Real, class F>
[[gnu::always_inline]] inline void visit_slots(const AugmentedStep<Real>& step, const Real* x,
                                               std::size_t begin, std::size_t end, const F& f) {
  for (std::size_t g = begin; g < end; ++g)
    for (int l = 0; l < kLanes; l += kWidth<T>) {
      const Vec3T<T> from = gather_packed<T>(x, step.groups[g].particle + l);
      for (std::uint32_t s = step.groups[g].first_slot; s < step.groups[g].end_slot; ++s) {
        AugmentedSlot<Real>& slot = step.slots[s];
        f(slot, l, norm(gather_packed<T>(x, slot.other + l) - from));
      }
    }
}

/// At a substep's start, with the stretch C_0 at x_t:
///
///     l *= alpha gamma;   k = clamp(gamma k, k_min, k_max)
template <class T, class Real>
void begin_augmented(const AugmentedStep<Real>& step_in, std::size_t begin, std::size_t end) {
  const AugmentedStep<Real> step = step_in;
  const T alpha(step.alpha), gamma(step.gamma), kept(step.alpha * step.gamma);
  const T k_min(step.k_min), k_max(step.k_max);
  visit_slots<T>(
      step, step.previous, begin,
      end, [&](AugmentedSlot<Real> & slot, int l, T length) __attribute__((always_inline)) {
        const T k = gamma * load<T>(slot.stiffness + l);
        store(slot.left + l, alpha * (length - load<T>(slot.rest + l)));
        store(slot.multiplier + l, kept * load<T>(slot.multiplier + l));
        store(slot.stiffness + l, lesser(greater(k, k_min), k_max));
      });
}

/// After a sweep:
///
///     l += k (C - alpha C_0);   k = min(k + beta |C - alpha C_0|, k_max)
template <class T, class Real>
void augment(const AugmentedStep<Real>& step_in, std::size_t begin, std::size_t end) {
  const AugmentedStep<Real> step = step_in;
  const T beta(step.beta), k_max(step.k_max);
  visit_slots<T>(
      step, step.x, begin,
      end, [&](AugmentedSlot<Real> & slot, int l, T length) __attribute__((always_inline)) {
        const T k = load<T>(slot.stiffness + l);
        const T violation = length - load<T>(slot.rest + l) - load<T>(slot.left + l);
        store(slot.multiplier + l, load<T>(slot.multiplier + l) + k * violation);
        store(slot.stiffness + l, lesser(k + beta * magnitude(violation), k_max));
      });
}

}  // namespace taut
