#include <numeric>

#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

class Pins final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {.name = "pins.force",
       .unit = kNumber,
       .help = "|force of all pins on the cloth| / (m g), mean over the last second; 1 at rest. "
               "Computed from the momentum P of the free vertices: dP/dt - m g, less the scene's "
               "damping; no value with colliders or wind, which push, too",
       .in_series = true,
       .title = "pin force over weight"},
      {.name = "pins.force.peak",
       .unit = kNumber,
       .help = "the same, largest over the run",
       .window = Window::run,
       .title = "largest pin force over weight"},
  };
  static bool measures(const Scene& scene) {
    return !scene.pins.empty() && scene.releases.empty() && !scene.gravity.isZero(0) &&
           scene.colliders.empty() && !scene.wind;
  }
  explicit Pins(const Scene& scene)
      : mass_(scene.mesh.mass),
        free_(free_vertices(scene)),
        weight_(std::accumulate(mass_.begin(), mass_.end(), 0.0) * scene.gravity),
        dt_(scene.dt),
        keep_(std::exp(-scene.damping * scene.dt)),
        end_(scene) {}

  void observe(const Snapshot& m) override {
    Vec3 momentum = Vec3::Zero();
    for (const std::size_t i : free_) momentum += mass_[i] * m.state.v[i];
    if (m.step > 0) {
      force_ = ((momentum - keep_ * momentum_) / dt_ - weight_).norm() / weight_.norm();
      summary_.add(m.step, end_.contains(m.step), force_);
    }
    momentum_ = momentum;
  }
  std::vector<double> finish() override { return {summary_.mean(), summary_.peak()}; }
  std::vector<double> now(const Snapshot&) const override { return {force_, Summary::kNone}; }

 private:
  std::vector<double> mass_;
  std::vector<std::size_t> free_;
  Vec3 weight_;  ///< N
  double dt_, keep_;
  LastSecond end_;
  Vec3 momentum_ = Vec3::Zero();   ///< kg m/s, a step ago
  double force_ = Summary::kNone;  ///< force in this step over the weight
  Summary summary_;
};

}  // namespace

TAUT_METRIC(pins, Pins, "What the pins carry", "momentum balance of the whole cloth");

}  // namespace taut
