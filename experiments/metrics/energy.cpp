#include "experiments/metrics/mechanical_energy.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

class Energy final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {"energy.mean", kNumber,
       "(kinetic + potential energy)/(m g L), potential energy 0 at the start, mean over the last "
       "second; L is the diagonal of the rest shape's bounding box",
       true},
      {"energy.kinetic", kNumber, "its kinetic part, mean over the last second", true},
      {"energy.peak", kNumber,
       "largest (kinetic + potential energy)/(m g L) after any step, not counting the start: below "
       "0 if the cloth never regains its initial energy",
       false, Window::run},
  };
  static bool measures(const Scene& scene) { return !scene.gravity.isZero(0); }
  explicit Energy(const Scene& scene) : energy_(scene), end_(scene) {}

  void observe(const Snapshot& m) override {
    const auto [kinetic, total] = measure(m.state);
    kinetic_.add(m.step, end_.contains(m.step), kinetic);
    total_.add(m.step, end_.contains(m.step), total);
  }
  std::vector<double> finish() override { return {total_.mean(), kinetic_.mean(), total_.peak()}; }
  std::vector<double> now(const Snapshot& m) const override {
    const auto [kinetic, total] = measure(m.state);
    return {total, kinetic, Summary::kNone};
  }

 private:
  struct Energies {
    double kinetic = 0, total = 0;  ///< in units of m g L
  };
  Energies measure(const State& state) const {
    const double kinetic = energy_.kinetic(state);
    return {kinetic / energy_.unit(), (kinetic + energy_.potential(state)) / energy_.unit()};
  }

  MechanicalEnergy energy_;
  LastSecond end_;
  Summary kinetic_, total_;
};

}  // namespace

TAUT_METRIC(energy, Energy, "Mechanical energy; relaxation dissipates it legitimately",
            "sum of m v^2/2 - m g . (x - x_start) over vertices, and the energy of bending, of the "
            "membrane and of elastic links");

}  // namespace taut
