#pragma once

#include <vector>

#include "core/solver/contact/deforming_contact.hpp"
#include "core/solver/contact/projector.hpp"
#include "core/solver/simd/collide_impl.hpp"
#include "core/solver/simd/coulomb.hpp"

namespace taut {

/// Pushes particles out of a body that deforms, one after another.
template <class Real>
class DeformingProjector final : public Projector<Real> {
 public:
  DeformingProjector(const Collider& collider, double thickness, bool continuous)
      : contact_(collider, thickness), continuous_(continuous) {}

  void begin(double t, double dt) override {
    if (queued_in_) queued_in_->finish();  // queued work reads the body of the last substep
    contact_.begin(t, dt);
  }

  void project(const ParticleSpan<Real>& span, std::size_t blocks,
               ThreadPool& pool) const override {
    queued_in_ = &pool;
    seen_.resize(span.parts() * (span.sheet.lanes > 1 ? span.sheet.stride : kLanes));
    pool.queue(
        blocks,
        [this, span](std::size_t begin, std::size_t end) {
          with_lanes<Real, Real, Real>(span, [&](Real, auto of_layout) {
            constexpr int lanes = of_layout;
            const auto one = [&](std::size_t place, bool present) {
              if (!present) return;
              const auto x = load_vec3<Real, lanes>(span.x + place);
              const auto previous = load_vec3<Real, lanes>(span.previous + place);
              Vec3 at = point(x).template cast<double>();
              Seen& seen = seen_[lanes == kPackedLanes ? place / 4 : place];
              if (moved_out(at, point(previous).template cast<double>(), seen))
                store_vec3<Real, lanes>(span.x + place, vec3t<Real>(at));
            };
            visit_particles<Real, lanes>(span, span.part_of_block(begin), span.part_of_block(end),
                                         one);
          });
        },
        span.particles >= ThreadPool::kWorthSharing);
  }

 private:
  /// Distance of a particle from the surface, its position in the body's frame, and the drift of
  /// the surface when it was looked up. The distance is now at least this, less the motion of both
  /// since.
  struct Seen {
    Vec3 at = Vec3::Zero();
    double distance = 0, drift = 0;  ///< m; distance 0: unknown
  };

  bool moved_out(Vec3& x, const Vec3& previous, Seen& seen) const {
    const auto path = contact_.path(x, previous);
    const double reach = contact_.reach(path, continuous_);
    if (contact_.beyond_all(path, reach)) return false;
    const double rounding = 1e-9 * contact_.body().after().reach();
    const double since = (path.to - seen.at).norm() + contact_.drift() - seen.drift;
    if (seen.distance - since > reach + rounding) return false;
    const NearestPlace nearest = contact_.nearest(path);
    seen = {path.to, nearest.distance, contact_.drift()};
    const auto touch = contact_.touch(path, nearest, continuous_, false);
    if (!touch || !push(*touch, x)) return false;
    if (continuous_) keep_from_others(x, previous);
    return true;
  }
  /// Like BodyContact::keep_from_others() at a rigid body (projector.cpp).
  void keep_from_others(Vec3& x, const Vec3& previous) const {
    const double rounding = 1e-9 * contact_.body().after().reach();
    constexpr int kOthers = 4;
    for (int round = 0; round <= kOthers; ++round) {
      const auto touch = contact_.passes(contact_.path(x, previous));
      if (!touch) return;
      const auto height = [&](const Vec3& p) { return touch->normal.dot(p) - touch->offset; };
      if (height(x) >= -rounding) return;
      if (round < kOthers)
        push(*touch, x);
      else if (const double from = height(touch->from); from > 0)
        x = touch->from + from / (2 * (from - height(x))) * (x - touch->from);
    }
  }

  /// Pushes x out of the surface. Friction is Coulomb's: it takes back at most the slip, and at
  /// most mu times the depth.
  bool push(const DeformingContact::Touch& touch, Vec3& x) const {
    const double depth = touch.offset + contact_.thickness() - touch.normal.dot(x);
    if (!(depth > 0)) return false;
    x += depth * touch.normal;
    Vec3 slip = x - touch.from;
    slip -= touch.normal.dot(slip) * touch.normal;
    x -= FrictionCone{slip.norm(), contact_.friction() * depth}.share() * slip;
    return true;
  }

  DeformingContact contact_;
  bool continuous_;
  mutable std::vector<Seen> seen_;  ///< by place of the particle
  mutable ThreadPool* queued_in_ = nullptr;
};

}  // namespace taut
