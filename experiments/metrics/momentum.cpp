#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

class Momentum final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {.name = "momentum.linear",
       .unit = kErrorSpeed,
       .help =
           "|P - P_start - m g t| / m for the momentum P of the whole cloth, largest over the run; "
           "has a value in free flight only, since pins, colliders, wind and damping change P",
       .in_series = true,
       .window = Window::run,
       .title = "error of momentum, per mass"},
      {.name = "momentum.angular",
       .unit = kErrorShare,
       .help = "|L - L_start| / |L_start| for the angular momentum L about the centre of mass, "
               "largest over the run; has a value in free flight that starts with a spin",
       .in_series = false,
       .window = Window::run,
       .title = "error of angular momentum"},
  };
  static bool measures(const Scene& scene) {
    return scene.pins.empty() && scene.colliders.empty() && !scene.wind && scene.damping == 0;
  }
  explicit Momentum(const Scene& scene) : mass_(scene.mesh.mass), gravity_(scene.gravity) {}

  void observe(const Snapshot& m) override {
    if (m.step == 0) {
      velocity_ = mean(mass_, m.state.v);
      spin_ = spin(m.state);
      if (spin_.norm() > 1e-9 * spin_of_parts(m.state)) spinning_ = true;
    }
    linear_.add(m.step, false, wrong(m));
    if (spinning_) angular_.add(m.step, false, (spin(m.state) - spin_).norm() / spin_.norm());
  }
  std::vector<double> finish() override { return {linear_.peak(), angular_.peak()}; }
  std::vector<double> now(const Snapshot& m) const override { return {wrong(m), Summary::kNone}; }

 private:
  double wrong(const Snapshot& m) const {
    return (mean(mass_, m.state.v) - velocity_ - m.t * gravity_).norm();
  }
  /// Angular momentum about the centre of mass [kg m^2/s].
  Vec3 spin(const State& s) const {
    const Vec3 center = mean(mass_, s.x);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < mass_.size(); ++i)
      sum += mass_[i] * (s.x[i] - center).cross(s.v[i]);
    return sum;
  }
  /// Sum of the parts of the angular momentum, which scales its rounding [kg m^2/s].
  double spin_of_parts(const State& s) const {
    const Vec3 center = mean(mass_, s.x);
    double sum = 0;
    for (std::size_t i = 0; i < mass_.size(); ++i)
      sum += mass_[i] * (s.x[i] - center).norm() * s.v[i].norm();
    return sum;
  }

  std::vector<double> mass_;
  Vec3 gravity_;
  Vec3 velocity_ = Vec3::Zero();  ///< m/s, velocity of the centre of mass at the start
  Vec3 spin_ = Vec3::Zero();      ///< kg m^2/s, at the start
  bool spinning_ = false;
  Summary linear_, angular_;
};

}  // namespace

TAUT_METRIC(momentum, Momentum, "Whether free flight conserves momentum and angular momentum",
            "Newton's second law for the whole cloth; inner forces come in pairs");

}  // namespace taut
