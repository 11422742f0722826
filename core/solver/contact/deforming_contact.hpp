#pragma once

#include <cmath>
#include <optional>

#include "core/model/deforming_body.hpp"
#include "core/solver/contact/contacts.hpp"

namespace taut {

/// A body that deforms, in one substep: the counterpart of Contact (simd/contact.hpp) for surfaces
/// that move as a whole, for one point at a time and in double. Two things differ. A path is tested
/// against every triangle's own path (DeformingBody::first_hit). Slip is relative to the surface
/// where the particle touches: to the point of the triangle, with the surroundings turning as the
/// triangle does.
class DeformingContact {
 public:
  DeformingContact(const Collider& collider, double thickness)
      : body_(collider), thickness_(thickness), friction_(collider.friction) {}

  void begin(double t, double h) {
    body_.move(t, t + h);
    drift_ += body_.longest_way();
  }

  const DeformingBody& body() const { return body_; }
  double friction() const { return friction_; }
  double thickness() const { return thickness_; }
  /// Upper bound of the displacement of any vertex since the start [m].
  double drift() const { return drift_; }

  /// A point's path through a substep, in the body's frame.
  struct Path {
    Vec3 from, to;
  };
  Path path(const Vec3& x, const Vec3& previous) const {
    return {body_.local_before(previous), body_.local(x)};
  }
  /// Distance from the path's end beyond which nothing can touch the point [m].
  double reach(const Path& path, bool continuous) const {
    if (!continuous) return thickness_;
    return thickness_ + 1.001 * (path.to - path.from).norm() + body_.longest_way();
  }
  bool beyond_all(const Path& path, double reach) const {
    return body_.after().box().squaredExteriorDistance(path.to) > reach * reach;
  }
  /// The nearest point of the surface at the end; for a thin body, seen from the side of the point.
  NearestPlace nearest(const Path& path) const {
    return seen_from_outside(body_.after().nearest(path.to));
  }

  /// A half-space from which the point must keep `thickness` [m], and the point's position without
  /// slip; in world coordinates.
  struct Touch {
    Vec3 normal;
    double offset;  ///< m
    Vec3 from;
    int triangle;
  };
  /// Whether the point is inside or `held` or, if `continuous`, has passed through the surface
  /// since the substep began. In the last case the half-space is on the side from which it came.
  std::optional<Touch> touch(const Path& path, const NearestPlace& nearest, bool continuous,
                             bool held) const {
    const bool near = held || nearest.distance < thickness_;
    const bool passing = continuous && nearest.distance < reach(path, true) - thickness_ / 2;
    if (passing)
      if (const auto entry = entered(path, nearest)) return entry;
    if (!near) return {};
    const PlaceMotion motion = body_.motion_of(nearest, path.to);
    return in_world(nearest.normal, motion.to, motion(path.from), nearest.triangle);
  }

  /// Where the point has passed through the surface since the substep began; empty if it has not.
  std::optional<Touch> passes(const Path& path) const { return entered(path, nearest(path)); }

 private:
  NearestPlace seen_from_outside(NearestPlace place) const {
    if (!body_.is_thin() || place.distance >= 0) return place;
    place.distance = -place.distance;
    place.normal = -place.normal;
    return place;
  }
  Touch in_world(const Vec3& normal, const Vec3& on, const Vec3& from, int triangle) const {
    const Vec3 out = body_.turned_to_world(normal);
    return {out, out.dot(body_.world(on)), body_.world(from), triangle};
  }

  /// Empty if the path passes through no triangle, or if the nearest point is on the side that it
  /// came through. A path without a hit stays inside if it ends inside: a point that began inside
  /// leaves at the nearest point of the surface.
  std::optional<Touch> entered(const Path& path, const NearestPlace& nearest) const {
    const auto hit = body_.first_hit(path.from, path.to);
    if (!hit && (body_.is_thin() || nearest.distance > 0)) return {};
    Vec3 normal;
    PlaceMotion motion;
    int triangle = 0;
    if (hit && (hit->inward || body_.is_thin())) {
      triangle = hit->triangle;
      normal = (hit->inward ? 1.0 : -1.0) * body_.after().normal(triangle);
      const Vec3 at = path.from + hit->share * (path.to - path.from);
      motion = body_.motion_of(triangle, body_.weights_at(*hit, at));
    } else {
      const NearestPlace start = seen_from_outside(body_.before().nearest(path.from));
      triangle = start.triangle;
      motion = body_.motion_of_before(start, path.from);
      normal = motion.turn * start.normal;
    }
    if (nearest.distance < 0 && nearest.normal.dot(normal) > 1e-6) return {};
    return in_world(normal, motion.to, motion(path.from), triangle);
  }

  DeformingBody body_;
  double thickness_, friction_;
  double drift_ = 0;
};

}  // namespace taut
