#include "core/model/bending.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// A turning point is a least kinetic energy that is at most this share of the largest before it
/// and of the largest after it: no ripple of a swing counts.
constexpr double kTurn = 0.25;

class EnergyLoss final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {.name = "energy.loss",
       .unit = kSignedShare,
       .help = "kinetic + potential energy lost from the first turning point to the last, over the "
               "sum of the largest kinetic energies between them; a turning point is a least "
               "kinetic energy of at most a quarter of the largest on either side; none with "
               "colliders, self-collision, wind, damping or moving pins, which do work",
       .window = Window::run,
       .title = "energy lost from peak to peak"},
  };
  static bool measures(const Scene& scene) {
    return !scene.gravity.isZero(0) && scene.colliders.empty() && !scene.self_collision &&
           !scene.wind && scene.damping == 0 && scene.pin_motions.empty();
  }
  explicit EnergyLoss(const Scene& scene)
      : mass_(scene.mesh.mass),
        bending_(make_bending(scene)),
        start_(scene.start.x),
        gravity_(scene.gravity) {}

  void observe(const Snapshot& m) override {
    const Moment now = measure(m.state);
    if (m.step == 0 || now.kinetic < least_.kinetic) least_ = now;
    if (now.kinetic > 0 && least_.kinetic <= kTurn * std::min(largest_, now.kinetic)) {
      turn();
      largest_ = now.kinetic, least_ = now;
    }
    if (now.kinetic > largest_) largest_ = now.kinetic, least_ = now;
  }
  std::vector<double> finish() override {
    return {exchanged_ > 0 ? (first_ - last_) / exchanged_ : Summary::kNone};
  }
  std::vector<double> now(const Snapshot&) const override { return {Summary::kNone}; }

 private:
  struct Moment {
    double kinetic = 0, total = 0;  ///< J
  };
  Moment measure(const State& s) const {
    Moment m;
    for (std::size_t i = 0; i < mass_.size(); ++i) {
      m.kinetic += mass_[i] * s.v[i].squaredNorm() / 2;
      m.total -= mass_[i] * gravity_.dot(s.x[i] - start_[i]);
    }
    m.total += m.kinetic + bending_energy(bending_, s.x);
    return m;
  }
  void turn() {
    if (turned_)
      exchanged_ += largest_;
    else
      first_ = least_.total;
    turned_ = true, last_ = least_.total;
  }

  std::vector<double> mass_;
  std::vector<BendingElement> bending_;
  std::vector<Vec3> start_;
  Vec3 gravity_;
  Moment least_;                 ///< since the largest kinetic energy after the last turning point
  double largest_ = 0;           ///< J, kinetic, since the last turning point
  bool turned_ = false;          ///< there was a turning point
  double first_ = 0, last_ = 0;  ///< J, at turning points
  double exchanged_ = 0;         ///< J, sum of the largest kinetic energies between them
};

}  // namespace

TAUT_METRIC(energy_loss, EnergyLoss, "Energy that a swing loses: artificial damping of any motion",
            "energies at successive turning points; 0 for rods and springs without damping");

}  // namespace taut
