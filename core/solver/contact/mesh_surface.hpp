#pragma once

#include <algorithm>

#include "core/model/collider.hpp"
#include "core/model/triangle_mesh.hpp"
#include "core/solver/simd/contact.hpp"

namespace taut {

/// A body of triangles at one moment, as surfaces.hpp has the closed forms, for one point at a
/// time: it looks the point up in the body's tree. Asked in Real, answered in double. Remembers the
/// last place, for the questions of one contact are about the same point: copied, not shared, by
/// whoever asks.
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

  bool clear(const Vector& x, Real thickness) const {
    return far(local(x), static_cast<double>(thickness)) ||
           at(x).distance >= static_cast<double>(thickness);
  }
  /// By twice the rounding of distances in Real.
  bool beyond(const Vector& x, Real way2, Real thickness) const {
    const double reach =
        static_cast<double>(thickness) + 1.001 * std::sqrt(static_cast<double>(way2));
    return far(local(x), reach) || at(x).distance >= reach;
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

  /// In the body's frame.
  Vec3 local(const Vector& x) const { return axes.transpose() * (world(x) - center); }
  /// Of what is outside [m]: exact where it has been looked up, else that of the box around it.
  double distance_at_least(const Vector& x) const {
    return knows(x) ? place_.distance : mesh->box().exteriorDistance(local(x));
  }

 private:
  static Vec3 world(const Vector& x) {
    return {static_cast<double>(x.x), static_cast<double>(x.y), static_cast<double>(x.z)};
  }
  static Tangent<Real> tangent(const Vec3& normal, double offset) {
    return {{static_cast<Real>(normal.x()), static_cast<Real>(normal.y()),
             static_cast<Real>(normal.z())},
            static_cast<Real>(offset)};
  }
  /// Outside of the box around it by so much; quick.
  bool far(const Vec3& p, double reach) const {
    return mesh->box().squaredExteriorDistance(p) > reach * reach;
  }
  bool knows(const Vector& x) const {
    return known_ && x.x == asked_.x && x.y == asked_.y && x.z == asked_.z;
  }
  const NearestPlace& at(const Vector& x) const {
    if (knows(x)) return place_;
    asked_ = x;
    place_ = mesh->nearest(local(x));
    if (thin && place_.distance < 0) {
      place_.distance = -place_.distance;
      place_.normal = -place_.normal;
    }
    known_ = true;
    return place_;
  }

  mutable bool known_ = false;
  mutable Vector asked_{};
  mutable NearestPlace place_;
};

}  // namespace taut
