#pragma once

#include <cmath>
#include <optional>

#include "core/model/deforming_body.hpp"
#include "core/solver/contact/contacts.hpp"

namespace taut {

/// A body that deforms, as one substep sees it: what Contact (simd/contact.hpp) is for surfaces
/// that move as a whole, for one point at a time and in double. Two things differ. A path is held
/// against every triangle's own way (DeformingBody::first_hit), and a particle's slip is that
/// against the surface where it touches: against the place of the triangle, and what is around it
/// as the triangle turns.
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
  double drift() const { return drift_; }  ///< m, of any vertex since the start, at most

  /// A point's way through a substep, in the body's frame.
  struct Path {
    Vec3 from, to;
  };
  Path path(const Vec3& x, const Vec3& previous) const {
    return {body_.local_before(previous), body_.local(x)};
  }
  /// From where on nothing can touch a point [m], at its end.
  double reach(const Path& path, bool continuous) const {
    if (!continuous) return thickness_;
    return thickness_ + 1.001 * (path.to - path.from).norm() + body_.longest_way();
  }
  bool beyond_all(const Path& path, double reach) const {
    return body_.after().box().squaredExteriorDistance(path.to) > reach * reach;
  }
  /// Of the surface at the end, from the side on which the point is if the body is thin.
  NearestPlace nearest(const Path& path) const {
    return seen_from_outside(body_.after().nearest(path.to));
  }

  /// A half-space that the point has to keep out of, by `thickness` [m], and where it would be if
  /// it had not slipped; in the world.
  struct Touch {
    Vec3 normal;
    double offset;  ///< m
    Vec3 from;
    int triangle;
  };
  /// Whether the point is inside, or `held`, or, `continuous`, has passed through the surface since
  /// the substep began: then it belongs to the side from which it came.
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

  /// Where the point has passed through the surface since the substep began, if it has.
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

  /// Nothing where the path goes through no triangle, or where the nearest place is on the side
  /// that it came through. A path without a hit stays inside if it ends inside: what began there
  /// leaves where it was nearest to the surface.
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
