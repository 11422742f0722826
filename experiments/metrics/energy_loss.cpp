#include "core/model/text.hpp"
#include "experiments/metrics/mechanical_energy.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// Largest kinetic energy at a turning point, as a share of the maximum before it and of the
/// maximum after it, so that no ripple of a swing counts.
constexpr double kTurn = 0.25;

/// Least energy that all swings together exchange, in units of m g L. Below it the cloth trembles
/// at rest.
constexpr double kSwing = 1e-3;

class EnergyLoss final : public Metric {
 public:
  static inline const ValueSpec kValues[] = {
      {.name = "energy.loss",
       .unit = kSignedShare,
       .help = lasting(
           "kinetic + potential energy lost from the first turning point to the last, over the sum "
           "of the largest kinetic energies between them; a turning point is a minimum of the "
           "kinetic energy of at most " +
           percent(kTurn) +
           " of the maximum on either side. No value with colliders, self-collision, wind, damping "
           "or moving pins, which do work; none if that sum is at most " +
           as_typed(kSwing) +
           " m g L (cloth at rest) or if the loss exceeds it (cloth that sinks and does not "
           "swing)"),
       .window = Window::run,
       .title = "energy lost from peak to peak"},
  };
  static bool measures(const Scene& scene) {
    return !scene.gravity.isZero(0) && scene.colliders.empty() && !scene.self_collision &&
           !scene.wind && scene.damping == 0 && scene.link_damping == 0 &&
           (!scene.membrane || scene.membrane->damping == 0) && scene.pin_motions.empty();
  }
  explicit EnergyLoss(const Scene& scene) : energy_(scene) {}

  void observe(const Snapshot& m) override {
    const Moment now = measure(m.state);
    if (m.step == 0 || now.kinetic < least_.kinetic) least_ = now;
    if (now.kinetic > 0 && least_.kinetic <= kTurn * std::min(largest_, now.kinetic)) {
      turn();
      largest_ = now.kinetic;
      least_ = now;
    }
    if (now.kinetic > largest_) {
      largest_ = now.kinetic;
      least_ = now;
    }
  }
  std::vector<double> finish() override {
    if (exchanged_ <= kSwing * energy_.unit()) return {Summary::kNone};
    const double loss = (first_ - last_) / exchanged_;
    return {loss <= 1 ? loss : Summary::kNone};
  }
  std::vector<double> now(const Snapshot&) const override { return {Summary::kNone}; }

 private:
  struct Moment {
    double kinetic = 0, total = 0;  ///< J
  };
  Moment measure(const State& s) const {
    const double kinetic = energy_.kinetic(s);
    return {kinetic, kinetic + energy_.potential(s)};
  }
  void turn() {
    if (turned_)
      exchanged_ += largest_;
    else
      first_ = least_.total;
    turned_ = true;
    last_ = least_.total;
  }

  MechanicalEnergy energy_;
  Moment least_;         ///< since the maximum of the kinetic energy after the last turning point
  double largest_ = 0;   ///< J, maximum of the kinetic energy since the last turning point
  bool turned_ = false;  ///< there was a turning point
  double first_ = 0, last_ = 0;  ///< J, at turning points
  double exchanged_ = 0;         ///< J, sum of the maxima of the kinetic energy between them
};

}  // namespace

TAUT_METRIC(energy_loss, EnergyLoss, "Energy that a swing loses: the solver's artificial damping",
            "energies at successive turning points; 0 for rods and springs without damping");

}  // namespace taut
