#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// Total force of all colliders on the cloth, by push and friction. If nothing is pinned and no
/// wind blows, forces between threads cancel, and the momentum changes by gravity, damping and
/// contact alone,
///
///     F = m ((c_n+1 - c_n) - e^(-damping dt) (c_n - c_n-1)) / dt^2 - m g,   c the centre of mass.
///
/// For a cloth at rest this is the weight. With substeps, velocities are displacements between step
/// boundaries, so the first step does not count.
class ContactForce final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {.name = "contact.force",
       .unit = kForce,
       .help = "magnitude of the mean total force of all colliders on the cloth over the last "
               "second, from the cloth's momentum; equals the weight if the cloth lies still",
       .title = "force of all colliders on the cloth"},
      {"contact.force.peak", kForce, "the largest over the run", false, Window::run,
       "largest force of all colliders on the cloth"},
  };
  static bool measures(const Scene& scene) {
    return !scene.colliders.empty() && scene.pins.empty() && !scene.wind;
  }
  explicit ContactForce(const Scene& scene)
      : mass_(scene.mesh.mass),
        gravity_(scene.gravity),
        keep_(std::exp(-scene.damping * scene.dt)),
        dt_(scene.dt),
        end_(scene) {
    for (const double m : mass_) total_ += m;
  }

  void observe(const Snapshot& m) override {
    const Vec3 center = mean(mass_, m.state.x);
    const Vec3 way = center - center_;
    center_ = center;
    if (m.step >= 2) {
      const Vec3 force = total_ * ((way - keep_ * way_) / (dt_ * dt_) - gravity_);
      peak_.add(m.step, false, force.norm());
      if (end_.contains(m.step)) {
        sum_ += force;
        ++count_;
      }
    }
    way_ = way;
  }
  std::vector<double> finish() override {
    return {count_ > 0 ? (sum_ / count_).norm() : Summary::kNone, peak_.peak()};
  }
  std::vector<double> now(const Snapshot&) const override {
    return {Summary::kNone, Summary::kNone};
  }

 private:
  std::vector<double> mass_;
  double total_ = 0;  ///< kg
  Vec3 gravity_;
  double keep_, dt_;
  LastSecond end_;
  Vec3 center_ = Vec3::Zero(), way_ = Vec3::Zero(), sum_ = Vec3::Zero();
  int count_ = 0;
  Summary peak_;
};

}  // namespace

TAUT_METRIC(contact_force, ContactForce, "Force with which colliders hold a cloth without pins",
            "momentum of the whole cloth");

}  // namespace taut
