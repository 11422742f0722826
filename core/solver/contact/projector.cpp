#include "core/solver/contact/projector.hpp"

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
  return std::make_unique<ProjectorOf<Real, BoxSurface>>(
      collider, thickness, continuous ? kernel.box_continuous : kernel.box);
}

template std::unique_ptr<Projector<float>> make_projector(const Collider&, double, bool, Simd);
template std::unique_ptr<Projector<double>> make_projector(const Collider&, double, bool, Simd);

}  // namespace taut
