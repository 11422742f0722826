#include "core/solver/contact/projector.hpp"

#include <vector>

#include "core/solver/contact/mesh_surface.hpp"
#include "core/solver/simd/collide_impl.hpp"

namespace taut {

PlaneSurface<double> surface_of(const Plane& plane) {
  return {vec3t<double>(plane.normal), plane.offset};
}

BallSurface<double> surface_of(const Ball& ball) {
  return {vec3t<double>(ball.center), ball.radius};
}

BoxSurface<double> surface_of(const Box& box) {
  const Eigen::Matrix3d axes = box.rotation.toRotationMatrix();
  return {vec3t<double>(box.center),
          vec3t<double>(box.half_extents),
          {vec3t<double>(axes.col(0)), vec3t<double>(axes.col(1)), vec3t<double>(axes.col(2))},
          box.half_extents.norm()};
}

CapsuleSurface<double> surface_of(const Capsule& capsule) {
  const Vec3 along = capsule.to - capsule.from;
  const double length2 = along.squaredNorm();
  return {vec3t<double>(capsule.from), vec3t<double>(along), length2 > 0 ? 1 / length2 : 0,
          capsule.radius, vec3t<double>(capsule.beside())};
}

RigidMotion<double> rigid_motion(const Motion& motion, double t, double dt) {
  if (motion.at_rest()) return {};
  const Eigen::Matrix3d turn =
      (motion.rotation(t + dt) * motion.rotation(t).conjugate()).toRotationMatrix();
  const Vec3 shift =
      motion.pivot + motion.displacement(t + dt) - turn * (motion.pivot + motion.displacement(t));
  return {true,
          {vec3t<double>(turn.row(0).transpose()), vec3t<double>(turn.row(1).transpose()),
           vec3t<double>(turn.row(2).transpose())},
          vec3t<double>(shift)};
}

namespace {

template <class Real, template <class> class SurfaceOf>
class ProjectorOf final : public Projector<Real> {
 public:
  ProjectorOf(const Collider& collider, double thickness, Collide<Real, SurfaceOf> collide)
      : collider_(collider), collide_(collide) {
    contact_.thickness = static_cast<Real>(thickness);
    contact_.friction = static_cast<Real>(collider.friction);
  }

  void begin(double t, double dt) override {
    using Shape = typename SurfaceOf<Real>::Shape;
    contact_.surface = rounded<Real>(surface_of(std::get<Shape>(shape_at(collider_, t + dt))));
    contact_.motion = rounded<Real>(rigid_motion(collider_.motion, t, dt));
  }

  void project(const ParticleSpan<Real>& span, std::size_t blocks,
               ThreadPool& pool) const override {
    pool.queue(
        blocks,
        [span, contact = contact_, collide = collide_](std::size_t begin, std::size_t end) {
          collide(contact, span, span.part_of_block(begin), span.part_of_block(end));
        },
        span.particles >= ThreadPool::kWorthSharing);
  }

 private:
  Collider collider_;
  Collide<Real, SurfaceOf> collide_;
  Contact<Real, SurfaceOf> contact_{};
};

/// A body of triangles, one particle after the other: what lies beside lanes, for each walk in the
/// tree is another.
///
/// A particle that was at distance d from the surface is at d - s at least when it has moved by s
/// against the body. So it remembers d and where that was, and hardly any particle is looked up in
/// every sweep.
template <class Real>
class MeshProjector final : public Projector<Real> {
 public:
  MeshProjector(const Collider& collider, double thickness, bool continuous)
      : collider_(collider), continuous_(continuous) {
    contact_.thickness = static_cast<Real>(thickness);
    contact_.friction = static_cast<Real>(collider.friction);
  }

  void begin(double t, double dt) override {
    body_ = std::get<MeshBody>(shape_at(collider_, t + dt));
    contact_.surface = MeshSurface<Real>(body_);
    contact_.motion = rounded<Real>(rigid_motion(collider_.motion, t, dt));
    rounding_ = 1e-6 * body_.mesh->reach();
  }

  void project(const ParticleSpan<Real>& span, std::size_t blocks,
               ThreadPool& pool) const override {
    seen_.resize(span.parts() * (span.sheet.lanes > 1 ? span.sheet.stride : kLanes));
    pool.queue(
        blocks,
        [this, span](std::size_t begin, std::size_t end) {
          with_lanes<Real, Real, Real>(span, [&](Real, auto lanes) {
            visit_particles<Real, lanes>(span, span.part_of_block(begin), span.part_of_block(end),
                                         [&](std::size_t place, bool present) {
                                           if (present) project_one<lanes>(span, place);
                                         });
          });
        },
        span.particles >= ThreadPool::kWorthSharing);
  }

 private:
  /// Where a particle was in the body's frame, and how far from its surface at least.
  struct Seen {
    Vec3 at = Vec3::Zero();
    double distance = 0;  ///< m; 0: nothing is known
  };

  template <int lanes>
  void project_one(const ParticleSpan<Real>& span, std::size_t place) const {
    Vec3T<Real> x = load_vec3<Real, lanes>(span.x + place);
    const Vec3T<Real> previous = load_vec3<Real, lanes>(span.previous + place);
    Seen& seen = seen_[lanes == kPackedLanes ? place / 4 : place];
    const Vec3 at = contact_.surface.local(x);
    const auto thickness = static_cast<double>(contact_.thickness);
    double reach = thickness;
    if (continuous_) reach += 1.01 * static_cast<double>(norm(x - contact_.motion(previous)));
    if (seen.distance - (at - seen.at).norm() > reach + rounding_) return;
    const Contact<Real, MeshSurface> contact = contact_;
    const bool near = continuous_ ? contact.template near<true>(x, previous)
                                  : contact.template near<false>(x, previous);
    if (!near) {
      seen = {at, contact.surface.distance_at_least(x)};
      return;
    }
    seen.distance = 0;
    const bool moved = continuous_ ? contact.project_continuous(x, previous, true)
                                   : contact.project(x, previous, true);
    if (moved) store_vec3<Real, lanes>(span.x + place, x);
  }

  Collider collider_;
  bool continuous_;
  MeshBody body_;
  Contact<Real, MeshSurface> contact_{};
  double rounding_ = 0;             ///< m, far beyond that of coordinates
  mutable std::vector<Seen> seen_;  ///< by place
};

}  // namespace

template <class Real>
std::unique_ptr<Projector<Real>> make_projector(const Collider& collider, double thickness,
                                                bool continuous, Simd simd) {
  const CollideKernels<Real>& kernel = kernels<Real>(simd).collide;
  if (std::holds_alternative<Plane>(collider.shape))
    return std::make_unique<ProjectorOf<Real, PlaneSurface>>(collider, thickness, kernel.plane);
  if (std::holds_alternative<Ball>(collider.shape))
    return std::make_unique<ProjectorOf<Real, BallSurface>>(
        collider, thickness, continuous ? kernel.ball_continuous : kernel.ball);
  if (std::holds_alternative<Capsule>(collider.shape))
    return std::make_unique<ProjectorOf<Real, CapsuleSurface>>(
        collider, thickness, continuous ? kernel.capsule_continuous : kernel.capsule);
  if (std::holds_alternative<MeshBody>(collider.shape))
    return std::make_unique<MeshProjector<Real>>(collider, thickness, continuous);
  return std::make_unique<ProjectorOf<Real, BoxSurface>>(
      collider, thickness, continuous ? kernel.box_continuous : kernel.box);
}

template std::unique_ptr<Projector<float>> make_projector(const Collider&, double, bool, Simd);
template std::unique_ptr<Projector<double>> make_projector(const Collider&, double, bool, Simd);

}  // namespace taut
