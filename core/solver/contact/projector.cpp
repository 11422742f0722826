#include "core/solver/contact/projector.hpp"

#include <bit>
#include <limits>
#include <optional>
#include <variant>
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

/// Four floats or two doubles, of the narrowest instruction set; separate from the lanes of other
/// files.
struct NearBody;
template <class Real>
using Few = Lanes<Real, 16 / sizeof(Real), NearBody>;

/// A body of triangles in a substep.
template <class Real>
struct BodyContact {
  Contact<Real, MeshSurface> contact;
  SphereSurface<Real> around;  ///< encloses the body
  Vec3T<Real> center;          ///< m, origin of the body's frame
  Vec3T<Real> axes[3];         ///< of the body's frame, in world coordinates
  Real rounding;               ///< m, far above the rounding of coordinates in Real
  Real noise;                  ///< m, rounding of coordinates in Real
  bool continuous;

  /// Quick test whether particles may touch: those in the sphere around the body, unless the
  /// position in the body's frame and the distance at which they were last seen show that they are
  /// clear.
  template <class T>
  [[gnu::always_inline]] auto may_touch(const Vec3T<T>& x, const Vec3T<T>& previous,
                                        const Vec3T<T>& seen_at, T seen_distance) const {
    using std::sqrt;
    const T way2 = continuous ? squared_norm(x - contact.motion(previous)) : T(0);
    const SphereSurface<T> sphere{spread_out<T>(around.center), T(around.radius), {}};
    const Vec3T<T> out = x - spread_out<T>(center);
    const Vec3T<T> moved =
        Vec3T<T>{dot(spread_out<T>(axes[0]), out), dot(spread_out<T>(axes[1]), out),
                 dot(spread_out<T>(axes[2]), out)} -
        seen_at;
    const T spare = seen_distance - T(contact.thickness + rounding) - T(1.01) * sqrt(way2);
    const auto clear = spare > T(0) && squared_norm(moved) < spare * spare;
    return !sphere.beyond(x, way2, T(contact.thickness)) && !clear;
  }

  /// Pushes x, which began the substep at `previous`, out of the body. Returns whether it was
  /// moved.
  bool project(Vec3T<Real>& x, const Vec3T<Real>& previous, Seen& seen) {
    contact.surface.ask_about(&seen);
    if (const auto moved = project_where_known(x, previous)) {
      if (*moved && continuous && contact.surface.thin) keep_from_others(x, previous);
      return *moved;
    }
    const bool near = continuous ? contact.template near<true>(x, previous)
                                 : contact.template near<false>(x, previous);
    if (!near) return false;
    if (!continuous) return contact.project(x, previous, true);
    if (!contact.project_continuous(x, previous, true)) return false;
    keep_from_others(x, previous);
    return true;
  }

 private:
  /// Pushes a vertex that was pushed out of one triangle out of another one behind which it lies,
  /// and so on. If that does not end, the vertex goes half of its path to the last triangle.
  void keep_from_others(Vec3T<Real>& x, const Vec3T<Real>& previous) const {
    const Vec3T<Real> from = contact.motion(previous);
    constexpr int kOthers = 4;
    for (int round = 0; round <= kOthers; ++round) {
      const Entry<Real> entry = contact.surface.entry(from, x);
      const auto height = [&](const Vec3T<Real>& p) {
        return dot(entry.tangent.normal, p) - entry.tangent.offset;
      };
      if (!entry.hits || height(x) >= -noise) return;
      if (round < kOthers)
        contact.push(x, from, entry.tangent, true);
      else if (height(from) > 0)
        x = from + height(from) / (2 * (height(from) - height(x))) * (x - from);
    }
  }
  /// Gives the same numbers for a particle that has hardly moved and cannot have passed through.
  std::optional<bool> project_where_known(Vec3T<Real>& x, const Vec3T<Real>& previous) {
    const auto distance = contact.surface.distance_if_known(x);
    if (!distance) return {};
    const Vec3T<Real> from = contact.motion(previous);
    if (continuous) {
      const double way = 1.001 * std::sqrt(static_cast<double>(squared_norm(x - from)));
      if (*distance < static_cast<double>(contact.thickness / 2) + way) return {};
    }
    if (*distance >= static_cast<double>(contact.thickness)) return false;
    return contact.push(x, from, contact.surface.nearest(x), true);
  }
};

/// Tests particles in lanes while they are clear, then one after another, because each walks
/// through the tree by itself.
template <class Real>
class MeshProjector final : public Projector<Real> {
 public:
  MeshProjector(const Collider& collider, double thickness, bool continuous) : collider_(collider) {
    body_.contact.thickness = static_cast<Real>(thickness);
    body_.contact.friction = static_cast<Real>(collider.friction);
    body_.continuous = continuous;
    const TriangleMesh& mesh = *std::get<MeshBody>(collider.shape).mesh;
    body_.around.radius = static_cast<Real>(1.001 * mesh.box().diagonal().norm() / 2);
  }

  void begin(double t, double dt) override {
    if (queued_in_) queued_in_->finish();  // queued work reads the body of the last substep
    const auto body = std::get<MeshBody>(shape_at(collider_, t + dt));
    body_.contact.surface = MeshSurface<Real>(body);
    body_.contact.motion = rounded<Real>(rigid_motion(collider_.motion, t, dt));
    body_.around.center = vec3t<Real>(body.center + body.rotation * body.mesh->box().center());
    body_.center = vec3t<Real>(body.center);
    const Eigen::Matrix3d axes = body.rotation.toRotationMatrix();
    for (Eigen::Index k = 0; k < 3; ++k) body_.axes[k] = vec3t<Real>(Vec3(axes.col(k)));
    const auto far = static_cast<Real>(body.mesh->reach() + body.center.norm());
    body_.rounding = static_cast<Real>(1e-5) * far;
    body_.noise = 8 * std::numeric_limits<Real>::epsilon() * far;
  }

  void project(const ParticleSpan<Real>& span, std::size_t blocks,
               ThreadPool& pool) const override {
    queued_in_ = &pool;
    const std::size_t length =
        span.parts() * (span.sheet.lanes > 1 ? span.sheet.stride : 4 * kLanes);
    seen_.resize(length);
    seen_at_.resize(length);
    seen_distance_.resize(length);
    pool.queue(
        blocks,
        [this, span](std::size_t begin, std::size_t end) {
          with_lanes<Few<Real>, Few<Real>, Real>(span, [&](auto t, auto of_layout) {
            visit<decltype(t), of_layout>(span, span.part_of_block(begin), span.part_of_block(end));
          });
        },
        span.particles >= ThreadPool::kWorthSharing);
  }

 private:
  template <class T, int lanes>
  void visit(const ParticleSpan<Real>& span, std::size_t begin, std::size_t end) const {
    BodyContact<Real> body = body_;
    const auto one = [&](std::size_t place, const auto& present) {
      const auto near = present && body.may_touch(load_vec3<T, lanes>(span.x + place),
                                                  load_vec3<T, lanes>(span.previous + place),
                                                  load_vec3<T, lanes>(seen_at_.data() + place),
                                                  load<T>(seen_distance_.data() + place));
      for (unsigned left = bits(near); left != 0; left &= left - 1) {
        const std::size_t at = place + static_cast<std::size_t>(std::countr_zero(left));
        Vec3T<Real> x = load_vec3<Real, lanes>(span.x + at);
        Seen& seen = seen_[at];
        if (body.project(x, load_vec3<Real, lanes>(span.previous + at), seen))
          store_vec3<Real, lanes>(span.x + at, x);
        store_vec3<Real, lanes>(seen_at_.data() + at, vec3t<Real>(seen.at));
        seen_distance_[at] = static_cast<Real>(seen.distance);
      }
    };
    visit_particles<T, lanes>(span, begin, end, one);
  }

  Collider collider_;
  BodyContact<Real> body_{};
  // Indexed by the place of x in memory; the last two are seen_ in the form that lanes need.
  mutable std::vector<Seen> seen_;
  mutable std::vector<Real> seen_at_, seen_distance_;
  mutable ThreadPool* queued_in_ = nullptr;
};

/// Makes the projector of a shape.
template <class Real>
struct ProjectorMaker {
  using Made = std::unique_ptr<Projector<Real>>;
  const Collider& collider;
  double thickness;
  bool continuous;
  const CollideKernels<Real>& kernel;

  Made operator()(const Plane&) const { return made(kernel.plane); }
  Made operator()(const Ball&) const {
    return made(continuous ? kernel.ball_continuous : kernel.ball);
  }
  Made operator()(const Box&) const {
    return made(continuous ? kernel.box_continuous : kernel.box);
  }
  Made operator()(const Capsule&) const {
    return made(continuous ? kernel.capsule_continuous : kernel.capsule);
  }
  Made operator()(const MeshBody&) const {
    if (collider.frames)
      return std::make_unique<DeformingProjector<Real>>(collider, thickness, continuous);
    return std::make_unique<MeshProjector<Real>>(collider, thickness, continuous);
  }

 private:
  template <template <class> class SurfaceOf>
  Made made(Collide<Real, SurfaceOf> collide) const {
    return std::make_unique<ProjectorOf<Real, SurfaceOf>>(collider, thickness, collide);
  }
};

}  // namespace

template <class Real>
std::unique_ptr<Projector<Real>> make_projector(const Collider& collider, double thickness,
                                                bool continuous, Simd simd) {
  return std::visit(
      ProjectorMaker<Real>{collider, thickness, continuous, kernels<Real>(simd).collide},
      collider.shape);
}

template std::unique_ptr<Projector<float>> make_projector(const Collider&, double, bool, Simd);
template std::unique_ptr<Projector<double>> make_projector(const Collider&, double, bool, Simd);

}  // namespace taut
