#include "core/solver/contact/projector.hpp"

#include "core/solver/contact/place.hpp"

namespace taut {

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
    contact_.carry = rounded<Real>(carry_of(collider_.motion, t, dt));
  }

  void project(const CollideSpan<Real>& span) const override { collide_(contact_, span); }

 private:
  Collider collider_;
  Collide<Real, SurfaceOf> collide_;
  Contact<Real, SurfaceOf> contact_{};
};

}  // namespace

template <class Real>
std::unique_ptr<Projector<Real>> make_projector(const Collider& collider, double thickness,
                                                bool swept, Simd simd) {
  const CollideKernels<Real>& kernel = kernels<Real>(simd).collide;
  if (std::holds_alternative<Plane>(collider.shape))
    return std::make_unique<ProjectorOf<Real, PlaneSurface>>(collider, thickness, kernel.plane);
  if (std::holds_alternative<Ball>(collider.shape))
    return std::make_unique<ProjectorOf<Real, BallSurface>>(
        collider, thickness, swept ? kernel.ball_swept : kernel.ball);
  return std::make_unique<ProjectorOf<Real, BoxSurface>>(collider, thickness,
                                                         swept ? kernel.box_swept : kernel.box);
}

template std::unique_ptr<Projector<float>> make_projector(const Collider&, double, bool, Simd);
template std::unique_ptr<Projector<double>> make_projector(const Collider&, double, bool, Simd);

}  // namespace taut
