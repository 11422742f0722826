#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/model/collider.hpp"

namespace taut {

/// The place of a surface to which a point belongs: the half-space normal . x >= offset.
template <class Real>
struct Tangent {
  Eigen::Matrix<Real, 3, 1> normal;
  Real offset = 0;  ///< m
};

// Colliders at one moment, as the contact loops want them: closed forms in the solver's own
// precision, one type for each shape. surface() of core/model/collider.hpp is their oracle.
//
//   clear(x, t)       quick and conservative: true only if x is at least t from the surface
//   beyond(x, w2, t)  the same for all of a path that ends in x and whose squared length is w2
//   misses(from, to)  quick and conservative: true only if entry(from, to) is empty
//   nearest(x)        tangent at the surface point nearest to x
//   entry(from, to)   tangent where a straight path first meets the solid; the one nearest to
//                     `from` if it starts inside; empty if it misses

template <class Real>
class PlaneSurface {
 public:
  using Point = Eigen::Matrix<Real, 3, 1>;
  using Shape = Plane;
  PlaneSurface() = default;
  explicit PlaneSurface(const Plane& plane)
      : tangent_{plane.normal.cast<Real>(), static_cast<Real>(plane.offset)} {}

  [[gnu::always_inline]] bool clear(const Point& x, Real thickness) const {
    return tangent_.normal.dot(x) >= tangent_.offset + thickness;
  }
  [[gnu::always_inline]] bool beyond(const Point& x, Real, Real thickness) const {
    return clear(x, thickness);
  }
  [[gnu::always_inline]] Tangent<Real> nearest(const Point&) const { return tangent_; }
  /// A half-space has no other side: nearest() says all.
  [[gnu::always_inline]] bool misses(const Point&, const Point&) const { return true; }
  std::optional<Tangent<Real>> entry(const Point&, const Point&) const { return {}; }

 private:
  Tangent<Real> tangent_;
};

template <class Real>
class BallSurface {
 public:
  using Point = Eigen::Matrix<Real, 3, 1>;
  using Shape = Ball;
  BallSurface() = default;
  explicit BallSurface(const Ball& ball)
      : center_(ball.center.cast<Real>()), radius_(static_cast<Real>(ball.radius)) {}

  [[gnu::always_inline]] bool clear(const Point& x, Real thickness) const {
    const Real reach = radius_ + thickness;
    return (x - center_).squaredNorm() >= reach * reach;
  }
  /// (reach + way)^2 <= 2 (reach^2 + way^2).
  [[gnu::always_inline]] bool beyond(const Point& x, Real way2, Real thickness) const {
    const Real reach = radius_ + thickness;
    return (x - center_).squaredNorm() >= 2 * (reach * reach + way2);
  }
  /// Both ends lie beyond the plane that touches the ball towards `from`.
  [[gnu::always_inline]] bool misses(const Point& from, const Point& to) const {
    const Point a = from - center_;
    const Real aa = a.squaredNorm(), ab = a.dot(to - center_), r2 = radius_ * radius_;
    return aa > r2 && ab > 0 && ab * ab > r2 * aa;
  }
  [[gnu::always_inline]] Tangent<Real> nearest(const Point& x) const {
    const Point out = x - center_;
    const Real distance = out.norm();
    return at(distance > 0 ? Point(out / distance) : Point::UnitY());
  }
  std::optional<Tangent<Real>> entry(const Point& from, const Point& to) const {
    const Point a = from - center_, d = to - from;
    const Real dd = d.squaredNorm(), ad = a.dot(d), above = a.squaredNorm() - radius_ * radius_;
    if (above <= 0) return nearest(from);
    const Real discriminant = ad * ad - dd * above;
    if (ad >= 0 || discriminant <= 0) return {};
    const Real share = above / (-ad + std::sqrt(discriminant));  // the nearer root, no cancellation
    if (share > 1) return {};
    return at((a + share * d) / radius_);
  }

 private:
  [[gnu::always_inline]] Tangent<Real> at(const Point& normal) const {
    return {normal, normal.dot(center_) + radius_};
  }
  Point center_;
  Real radius_ = 0;
};

template <class Real>
class BoxSurface {
 public:
  using Point = Eigen::Matrix<Real, 3, 1>;
  using Shape = Box;
  BoxSurface() = default;
  explicit BoxSurface(const Box& box)
      : center_(box.center.cast<Real>()),
        half_(box.half_extents.cast<Real>()),
        axes_(box.rotation.toRotationMatrix().cast<Real>()),
        far_(static_cast<Real>(box.half_extents.norm())) {}

  [[gnu::always_inline]] bool clear(const Point& x, Real thickness) const {
    const Point out = x - center_;
    const Real reach = far_ + thickness;
    if (out.squaredNorm() >= reach * reach) return true;
    return ((axes_.transpose() * out).cwiseAbs() - half_).maxCoeff() >= thickness;
  }
  [[gnu::always_inline]] bool beyond(const Point& x, Real way2, Real thickness) const {
    const Real reach = far_ + thickness;
    return (x - center_).squaredNorm() >= 2 * (reach * reach + way2);
  }
  /// Both ends lie beyond the same side.
  [[gnu::always_inline]] bool misses(const Point& from, const Point& to) const {
    const Point a = axes_.transpose() * (from - center_), b = axes_.transpose() * (to - center_);
    return (a.cwiseMin(b) - half_).maxCoeff() > 0 || (a.cwiseMax(b) + half_).minCoeff() < 0;
  }
  [[gnu::always_inline]] Tangent<Real> nearest(const Point& x) const {
    const Point local = axes_.transpose() * (x - center_);
    const Point excess = local.cwiseAbs() - half_;
    Eigen::Index axis = 0;
    if (excess.maxCoeff(&axis) <= 0) return face(axis, local[axis] < 0 ? Real(-1) : Real(1));
    const Point corner = local.cwiseMax(-half_).cwiseMin(half_);
    const Point normal = axes_ * (local - corner).normalized();
    return {normal, normal.dot(center_ + axes_ * corner)};
  }
  std::optional<Tangent<Real>> entry(const Point& from, const Point& to) const {
    const Point a = axes_.transpose() * (from - center_), d = axes_.transpose() * (to - from);
    if ((a.cwiseAbs() - half_).maxCoeff() <= 0) return nearest(from);
    Real in = -std::numeric_limits<Real>::infinity(), out = 1;
    Eigen::Index side = 0;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {  // the path is inside between in and out
      if (d[axis] == 0) {
        if (std::abs(a[axis]) >= half_[axis]) return {};
        continue;
      }
      const Real toward = d[axis] > 0 ? Real(1) : Real(-1);
      const Real enters = (-toward * half_[axis] - a[axis]) / d[axis];
      if (enters > in) in = enters, side = axis;
      out = std::min(out, (toward * half_[axis] - a[axis]) / d[axis]);
    }
    if (in < 0 || in >= out) return {};
    return face(side, d[side] > 0 ? Real(-1) : Real(1));
  }

 private:
  [[gnu::always_inline]] Tangent<Real> face(Eigen::Index axis, Real sign) const {
    const Point normal = sign * axes_.col(axis);
    return {normal, normal.dot(center_) + half_[axis]};
  }
  Point center_, half_;
  Eigen::Matrix<Real, 3, 3> axes_;  ///< columns: the box's axes in the world
  Real far_ = 0;                    ///< m, from the centre to a corner
};

}  // namespace taut
