#pragma once

#include <memory>

#include "core/model/collider.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"
#include "core/solver/thread_pool.hpp"

namespace taut {

// Conversions between the model and the types of the contact loops, which do not use Eigen.

PlaneSurface<double> surface_of(const Plane&);
BallSurface<double> surface_of(const Ball&);
BoxSurface<double> surface_of(const Box&);
CapsuleSurface<double> surface_of(const Capsule&);

/// Rigid motion from time t to t + dt [s].
RigidMotion<double> rigid_motion(const Motion&, double t, double dt);

template <class Real, class Vector>
Vec3T<Real> vec3t(const Vector& v) {
  return {static_cast<Real>(v.x()), static_cast<Real>(v.y()), static_cast<Real>(v.z())};
}
template <class Real>
Eigen::Matrix<Real, 3, 1> point(const Vec3T<Real>& t) {
  return {t.x, t.y, t.z};
}

// Conversions to the solver's precision.
template <class Real>
Vec3T<Real> rounded(const Vec3T<double>& t) {
  return {static_cast<Real>(t.x), static_cast<Real>(t.y), static_cast<Real>(t.z)};
}
template <class Real>
PlaneSurface<Real> rounded(const PlaneSurface<double>& plane) {
  return {rounded<Real>(plane.normal), static_cast<Real>(plane.offset)};
}
template <class Real>
BallSurface<Real> rounded(const BallSurface<double>& ball) {
  return {rounded<Real>(ball.center), static_cast<Real>(ball.radius)};
}
template <class Real>
BoxSurface<Real> rounded(const BoxSurface<double>& box) {
  return {rounded<Real>(box.center),
          rounded<Real>(box.half),
          {rounded<Real>(box.axes[0]), rounded<Real>(box.axes[1]), rounded<Real>(box.axes[2])},
          static_cast<Real>(box.far)};
}
template <class Real>
CapsuleSurface<Real> rounded(const CapsuleSurface<double>& capsule) {
  return {rounded<Real>(capsule.start), rounded<Real>(capsule.along),
          static_cast<Real>(capsule.per_length2), static_cast<Real>(capsule.radius),
          rounded<Real>(capsule.beside)};
}
template <class Real>
RigidMotion<Real> rounded(const RigidMotion<double>& c) {
  return {c.moves,
          {rounded<Real>(c.turn[0]), rounded<Real>(c.turn[1]), rounded<Real>(c.turn[2])},
          rounded<Real>(c.shift)};
}

/// Pushes particles out of a collider, step after step. Particles are processed as they lie in
/// memory, several at once.
template <class Real>
class Projector {
 public:
  virtual ~Projector() = default;
  /// Begins the step [t, t + dt].
  virtual void begin(double t, double dt) = 0;
  /// Queues the projection.
  virtual void project(const ParticleSpan<Real>&, std::size_t blocks, ThreadPool&) const = 0;
};

/// Makes a projector that keeps particles at `thickness` [m]. continuous: also catches particles
/// that passed through the collider since the step began.
template <class Real>
std::unique_ptr<Projector<Real>> make_projector(const Collider&, double thickness, bool continuous,
                                                Simd);

/// All particles, with x stored by the caller.
template <class Real>
ParticleSpan<Real> span_of(const Particles<Real>& p, Points<Real>& x) {
  return {x.data(), p.previous.data(), p.layout->sheet(), p.size()};
}

}  // namespace taut
