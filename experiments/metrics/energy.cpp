#include <numeric>

#include "core/model/bending.hpp"
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
       "largest (kinetic + potential energy)/(m g L) after any step, the start left out: below 0 "
       "if "
       "the cloth never has again what it had there",
       false, Window::run},
  };
  static bool measures(const Scene& scene) { return !scene.gravity.isZero(0); }
  explicit Energy(const Scene& scene)
      : mass_(scene.mesh.mass),
        bending_(make_bending(scene)),
        start_(scene.start.x),
        gravity_(scene.gravity),
        end_(scene) {
    const double total = std::accumulate(mass_.begin(), mass_.end(), 0.0);
    bent_at_start_ = bending_energy(bending_, start_);
    unit_ = total * gravity_.norm() * extent(scene);
  }

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
    double kinetic = 0, potential = bending_energy(bending_, state.x) - bent_at_start_;
    for (std::size_t i = 0; i < mass_.size(); ++i) {
      kinetic += mass_[i] * state.v[i].squaredNorm() / 2;
      potential -= mass_[i] * gravity_.dot(state.x[i] - start_[i]);
    }
    return {kinetic / unit_, (kinetic + potential) / unit_};
  }

  std::vector<double> mass_;
  std::vector<BendingElement> bending_;
  double bent_at_start_ = 0;  ///< J
  std::vector<Vec3> start_;
  Vec3 gravity_;
  LastSecond end_;
  double unit_ = 0;  ///< m g L [J]
  Summary kinetic_, total_;
};

}  // namespace

TAUT_METRIC(energy, Energy, "Mechanical energy; relaxation dissipates it legitimately",
            "sum of m v^2/2 - m g . (x - x_start) over vertices, and the energy of bending");

}  // namespace taut
