#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/model/collider.hpp"
#include "core/model/triangle_mesh.hpp"
#include "core/solver/simd/contact.hpp"

namespace taut {

/// Position of a particle in a body's frame when it was last looked up, and what follows for nearby
/// positions. Valid while the body keeps its shape, however it moves.
struct Seen {
  Vec3 at = Vec3::Zero();
  double distance = 0;  ///< m, lower bound if outside; 0: unknown
  TriangleMesh::Nearby nearby;

  /// Whether `now` is surely at least `reach` from the surface.
  bool tells_clear(const Vec3& now, double reach) const {
    const double spare = distance - reach;
    return spare > 0 && (now - at).squaredNorm() < spare * spare;
  }
};

/// A body of triangles at one moment, with the functions of the closed forms in surfaces.hpp, for
/// one point at a time: it looks the point up in the body's tree. Arguments are Real, computation
/// is in double. It remembers the last position, since the questions of one contact are about one
/// point; each user therefore works on a copy. A particle's Seen saves most walks in the tree and
/// gives the same bits.
template <class Real>
struct MeshSurface {
  using Shape = MeshBody;
  using Vector = Vec3T<Real>;
  const TriangleMesh* mesh = nullptr;
  Vec3 center = Vec3::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< frame -> world
  bool thin = false;

  MeshSurface() = default;  ///< of no body
  explicit MeshSurface(const MeshBody& body)
      : mesh(body.mesh.get()),
        center(body.center),
        axes(body.rotation.toRotationMatrix()),
        thin(body.sides == MeshBody::Sides::both) {}

  /// Sets the particle that the following questions are about; null: any point.
  void ask_about(Seen* seen) {
    seen_ = seen;
    known_ = false;
  }

  /// Distance if the particle has hardly moved since it was looked up in the tree [m].
  std::optional<double> distance_if_known(const Vector& x) const {
    const Vec3 p = local(x);
    if (!seen_->nearby.know(p)) return {};
    return look_up(x, p).distance;
  }
  bool clear(const Vector& x, Real thickness) const {
    return distance_at_least(x, static_cast<double>(thickness)) >= static_cast<double>(thickness);
  }
  /// Whether a way of this squared length cannot bring x closer than `thickness`, with a margin for
  /// rounding.
  bool beyond(const Vector& x, Real way2, Real thickness) const {
    const double reach =
        static_cast<double>(thickness) + 1.001 * std::sqrt(static_cast<double>(way2));
    return distance_at_least(x, reach) >= reach;
  }
  bool misses(const Vector& from, const Vector& to) const {
    const Vec3 a = local(from), b = local(to);
    return !Eigen::AlignedBox3d(a.cwiseMin(b), a.cwiseMax(b)).intersects(mesh->box());
  }
  Tangent<Real> nearest(const Vector& x) const {
    const NearestPlace& place = at(x);
    const Vec3 normal = axes * place.normal;
    return tangent(normal, normal.dot(world(x)) - place.distance);
  }
  /// A path without a hit stays inside if it ends inside.
  Entry<Real> entry(const Vector& from, const Vector& to) const {
    const auto hit = mesh->first_hit(local(from), local(to));
    if (!hit && (thin || at(to).distance > 0)) return {false, {}};
    if (!hit || (!hit->inward && !thin)) return {true, nearest(from)};
    const Vec3 normal = axes * (hit->inward ? 1.0 : -1.0) * mesh->normal(hit->triangle);
    const Vec3 met = world(from) + hit->share * (world(to) - world(from));
    return {true, tangent(normal, normal.dot(met))};
  }

  /// x in the body's frame.
  Vec3 local(const Vector& x) const { return axes.transpose() * (world(x) - center); }

 private:
  static Vec3 world(const Vector& x) {
    return {static_cast<double>(x.x), static_cast<double>(x.y), static_cast<double>(x.z)};
  }
  static Tangent<Real> tangent(const Vec3& normal, double offset) {
    return {{static_cast<Real>(normal.x()), static_cast<Real>(normal.y()),
             static_cast<Real>(normal.z())},
            static_cast<Real>(offset)};
  }
  bool knows(const Vector& x) const {
    return known_ && x.x == asked_.x && x.y == asked_.y && x.z == asked_.z;
  }
  /// Distance, exact if it is below `reach`.
  double distance_at_least(const Vector& x, double reach) const {
    if (knows(x)) return place_.distance;
    const Vec3 p = local(x);
    if (seen_ && seen_->tells_clear(p, reach)) return std::numeric_limits<double>::infinity();
    const double of_box = mesh->box().exteriorDistance(p);
    if (of_box > reach) {
      if (seen_) {
        seen_->at = p;
        seen_->distance = of_box - kRounding * mesh->reach();
      }
      return of_box;
    }
    return look_up(x, p).distance;
  }
  const NearestPlace& at(const Vector& x) const { return knows(x) ? place_ : look_up(x, local(x)); }
  const NearestPlace& look_up(const Vector& x, const Vec3& p) const {
    asked_ = x;
    known_ = true;
    if (!seen_) {
      place_ = mesh->nearest(p);
    } else {
      place_ = mesh->nearest(p, seen_->nearby);
      seen_->at = p;
      seen_->distance =
          (thin ? std::abs(place_.distance) : place_.distance) - kRounding * mesh->reach();
    }
    if (thin && place_.distance < 0) {
      place_.distance = -place_.distance;
      place_.normal = -place_.normal;
    }
    return place_;
  }

  static constexpr double kRounding = 1e-10;  ///< far above the rounding of coordinates
  Seen* seen_ = nullptr;
  mutable bool known_ = false;
  mutable Vector asked_{};
  mutable NearestPlace place_;
};

}  // namespace taut
