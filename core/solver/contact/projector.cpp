#include "core/solver/contact/projector.hpp"

#include <vector>

#include "core/solver/contact/deforming_projector.hpp"
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

/// Where a particle was in a body's frame, and how far from its surface at least.
struct Seen {
  Vec3 at = Vec3::Zero();
  double distance = 0;  ///< m; 0: nothing is known
};

/// A body of triangles in a substep. A particle that was at distance d from the surface is at d - s
/// at least when it has moved by s against the body: it remembers d and where that was, and hardly
/// any particle is looked up in every sweep.
template <class Real>
struct BodyContact {
  Contact<Real, MeshSurface> contact;
  SphereSurface<Real> around;  ///< all of it
  double rounding;             ///< m, far beyond that of coordinates
  bool continuous;

  /// Whether x, which began the substep at `previous`, has been moved.
  bool project(Vec3T<Real>& x, const Vec3T<Real>& previous, Seen& seen) const {
    const Real thickness = contact.thickness;
    const Real way2 = continuous ? squared_norm(x - contact.motion(previous)) : Real(0);
    if (around.beyond(x, way2, thickness)) return false;
    const Vec3 at = contact.surface.local(x);
    const double reach =
        static_cast<double>(thickness) + 1.01 * std::sqrt(static_cast<double>(way2));
    if (seen.distance - (at - seen.at).norm() > reach + rounding) return false;
    const Contact<Real, MeshSurface> asked = contact;
    const bool near = continuous ? asked.template near<true>(x, previous)
                                 : asked.template near<false>(x, previous);
    seen = {at, near ? 0 : asked.surface.distance_at_least(x)};
    if (!near) return false;
    return continuous ? asked.project_continuous(x, previous, true)
                      : asked.project(x, previous, true);
  }
};

/// One particle after the other, beside the lanes: each walks in the tree for itself.
template <class Real>
class MeshProjector final : public Projector<Real> {
 public:
  MeshProjector(const Collider& collider, double thickness, bool continuous) : collider_(collider) {
    body_.contact.thickness = static_cast<Real>(thickness);
    body_.contact.friction = static_cast<Real>(collider.friction);
    body_.continuous = continuous;
    const TriangleMesh& mesh = *std::get<MeshBody>(collider.shape).mesh;
    body_.around.radius = static_cast<Real>(1.001 * mesh.box().diagonal().norm() / 2);
    body_.rounding = 1e-6 * mesh.reach();
  }

  void begin(double t, double dt) override {
    if (queued_in_) queued_in_->finish();  // what is queued reads the body of the last substep
    const auto body = std::get<MeshBody>(shape_at(collider_, t + dt));
    body_.contact.surface = MeshSurface<Real>(body);
    body_.contact.motion = rounded<Real>(rigid_motion(collider_.motion, t, dt));
    body_.around.center = vec3t<Real>(body.center + body.rotation * body.mesh->box().center());
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
              Vec3T<Real> x = load_vec3<Real, lanes>(span.x + place);
              Seen& seen = seen_[lanes == kPackedLanes ? place / 4 : place];
              if (body_.project(x, load_vec3<Real, lanes>(span.previous + place), seen))
                store_vec3<Real, lanes>(span.x + place, x);
            };
            visit_particles<Real, lanes>(span, span.part_of_block(begin), span.part_of_block(end),
                                         one);
          });
        },
        span.particles >= ThreadPool::kWorthSharing);
  }

 private:
  Collider collider_;
  BodyContact<Real> body_{};
  mutable std::vector<Seen> seen_;  ///< by place
  mutable ThreadPool* queued_in_ = nullptr;
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
  if (collider.frames)
    return std::make_unique<DeformingProjector<Real>>(collider, thickness, continuous);
  if (std::holds_alternative<MeshBody>(collider.shape))
    return std::make_unique<MeshProjector<Real>>(collider, thickness, continuous);
  return std::make_unique<ProjectorOf<Real, BoxSurface>>(
      collider, thickness, continuous ? kernel.box_continuous : kernel.box);
}

template std::unique_ptr<Projector<float>> make_projector(const Collider&, double, bool, Simd);
template std::unique_ptr<Projector<double>> make_projector(const Collider&, double, bool, Simd);

}  // namespace taut
