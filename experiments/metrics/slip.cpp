#include <optional>

#include "core/model/triangle_mesh.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// Outward normal of a plane, or of a body whose triangles are all in one plane.
std::optional<Vec3> flat_normal(const Shape& shape) {
  if (const Plane* plane = std::get_if<Plane>(&shape)) return plane->normal;
  const MeshBody* body = std::get_if<MeshBody>(&shape);
  if (!body) return {};
  const Vec3& normal = body->mesh->normal(0);
  const std::vector<Vec3>& corners = body->mesh->vertices();
  const double noise = 1e-12 * body->mesh->reach();
  for (std::size_t t = 0; t < body->mesh->triangles().size(); ++t)
    if ((body->mesh->normal(static_cast<int>(t)) - normal).norm() > 1e-9) return {};
  for (const Vec3& x : corners)
    if (std::abs(normal.dot(x - corners[0])) > noise) return {};
  return body->rotation * normal;
}

/// Friction of the whole cloth on one plane. Forces between its threads cancel, so gravity, damping
/// and the plane alone move its centre of mass c. The contact impulse of a step per mass is
///
///     j = v' - keep v - g dt,   v = (c_n - c_(n-1))/dt - velocity of the plane, keep = e^(-d dt),
///
/// Coulomb's law, implicit in the velocity as for a block on the plane, lets friction take mu n . j
/// off the tangential velocity that the cloth would have without it, and at most all of it. A part
/// of a cloth may slide while another sticks. The cloth can then only be held to the law's bound,
/// and a cloth that deforms while it lies still shows some error.
///
/// The velocity is the displacement between two step boundaries over dt. In the first step a solver
/// with n substeps moves by v0 dt + a dt^2 (1 + 1/n)/2, and later steps gain a dt each, whatever n.
/// The block therefore starts with the cloth's velocity in the first step.
class Slip final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {"slip.error", kErrorAcceleration,
       "difference between the acceleration of the centre of mass along the plane and the one that "
       "Coulomb's law gives for the normal force that acted, mean over the last second"},
      {"slip.error.peak", kErrorAcceleration, "the same, largest over the run", false, Window::run},
      {.name = "slip.distance",
       .unit = kErrorLength,
       .help = "distance along the plane between the centre of mass and a block under the same "
               "normal forces, at the end",
       .in_series = true,
       .window = Window::end,
       .title = "distance from Coulomb's law",
       .role = Role::contact_error,
       .shown_over_time = true},
  };
  /// Whether only gravity and one plane that does not turn act on the cloth.
  static bool measures(const Scene& scene) {
    if (scene.colliders.size() != 1 || !scene.pins.empty() || scene.wind) return false;
    const Collider& collider = scene.colliders[0];
    return flat_normal(collider.shape) && collider.motion.spin.isZero(0) &&
           collider.motion.path.empty();
  }
  explicit Slip(const Scene& scene)
      : mass_(scene.mesh.mass),
        normal_(side_of(scene) * *flat_normal(scene.colliders[0].shape)),
        plane_velocity_(scene.colliders[0].motion.velocity),
        g_dt_(scene.gravity * scene.dt),
        keep_(std::exp(-scene.damping * scene.dt)),
        friction_(scene.colliders[0].friction),
        dt_(scene.dt),
        end_(scene) {}

  void observe(const Snapshot& m) override {
    const Vec3 center = mean(mass_, m.state.x);
    const Vec3 next = (center - center_) / dt_;
    if (m.step == 1) {
      velocity_ = block_ = next;
    } else if (m.step > 1) {
      const double press = std::max(0.0, normal_.dot(next - drift(velocity_)));
      const Vec3 expected = rubbed(drift(velocity_), press);
      error_.add(m.step, end_.contains(m.step), along(next - expected).norm() / dt_);
      block_ = rubbed(drift(block_), press);
      apart_ += along(next - block_) * dt_;
      velocity_ = next;
    }
    center_ = center;
  }
  std::vector<double> finish() override { return {error_.mean(), error_.peak(), apart_.norm()}; }
  std::vector<double> now(const Snapshot&) const override {
    return {Summary::kNone, Summary::kNone, apart_.norm()};
  }

 private:
  /// Sign of the side of a body with two sides on which the cloth is.
  static double side_of(const Scene& scene) {
    const Shape& shape = scene.colliders[0].shape;
    const Vec3 center = mean(scene.mesh.mass, scene.start.x);
    return surface(shape, center).normal.dot(*flat_normal(shape)) < 0 ? -1 : 1;
  }
  /// v after a step without contact.
  Vec3 drift(const Vec3& v) const { return keep_ * v + g_dt_; }

  /// v after friction under the normal impulse `press` [m/s]; only the part of v along the plane
  /// counts.
  Vec3 rubbed(const Vec3& v, double press) const {
    const Vec3 slides = along(v - plane_velocity_);
    const double speed = slides.norm(), most = friction_ * press;
    return v - (speed <= most ? slides : Vec3(most / speed * slides));
  }

  Vec3 along(const Vec3& v) const { return v - normal_.dot(v) * normal_; }

  std::vector<double> mass_;
  Vec3 normal_, plane_velocity_, g_dt_;
  double keep_, friction_, dt_;
  LastSecond end_;
  Vec3 center_ = Vec3::Zero(), velocity_ = Vec3::Zero();  ///< of the cloth
  Vec3 block_ = Vec3::Zero();                             ///< velocity of the block
  Vec3 apart_ = Vec3::Zero();                             ///< m, distance along the plane
  Summary error_;
};

}  // namespace

TAUT_METRIC(slip, Slip, "Whether friction on a plane or a flat body obeys Coulomb's law",
            "momentum of the whole cloth against Coulomb's law, step by step");

}  // namespace taut
