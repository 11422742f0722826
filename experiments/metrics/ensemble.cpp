#include <memory>
#include <optional>
#include <string>

#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/metrics/observables.hpp"
#include "experiments/metrics/reference.hpp"

namespace taut {

namespace {

/// Means of observables over time, beside those of an ensemble of references.
class EnsembleDistance final : public Metric {
 public:
  static inline const ValueSpec kValues[] = {
      {.name = kEnsembleError,
       .unit = kErrorShare,
       .help = lasting(
           "largest of: distance of the centre of mass and of the second moment's lengths from the "
           "mean of an ensemble of perturbed references, over the fall; difference of the share of "
           "vertices in contact, within " +
           percent(Observables::kTouch) +
           " of the cloth's size beyond its thickness. Each is a mean over the time for which the "
           "ensemble is known. No value if the run ends before"),
       .window = Window::none,
       .title = "distance from where the cloth comes to rest",
       .role = Role::motion_error,
       .negligible = 1e-2,
       .floor = {"ensemble.floor", "how far the references of the ensemble differ"}},
      {.name = kEnsembleFloor,
       .unit = kShare,
       .help =
           "twice the standard deviation of the worst observable over the ensemble's references",
       .window = Window::none},
      {.name = kEnsemblePlate,
       .unit = kShare,
       .help = "ensemble.error of a rigid plate that falls from the start and rests on the body",
       .window = Window::none},
  };

  EnsembleDistance(const Scene& scene, Ensemble known) : scene_(scene), known_(std::move(known)) {}

  void observe(const Snapshot& m) override {
    last_ = m.t;
    if (m.t < known_.from - kTiny || m.t > known_.to + kTiny) return;
    sum_ += observables(scene_, m.state.x, m.t);
    ++count_;
  }
  std::vector<double> finish() override {
    const bool known = count_ > 0 && last_ >= known_.to - scene_.dt;
    return {known ? apart(sum_ * (1.0 / count_), known_.mean, known_.fall) : Summary::kNone,
            known_.floor, known_.plate};
  }
  std::vector<double> now(const Snapshot&) const override {
    return std::vector<double>(std::size(kValues), Summary::kNone);
  }

 private:
  static constexpr double kTiny = 1e-9;  ///< s
  const Scene& scene_;                   ///< the run's scene, which outlives its metrics
  Ensemble known_;
  Observables sum_;
  int count_ = 0;
  double last_ = 0;  ///< s
};

}  // namespace

/// Reads the references once.
template <>
std::unique_ptr<Metric> make_metric<EnsembleDistance>(const Scene& scene) {
  std::optional<Ensemble> known = known_references(scene).ensemble;
  return known ? std::make_unique<EnsembleDistance>(scene, std::move(*known)) : nullptr;
}

TAUT_METRIC(ensemble, EnsembleDistance,
            "How far the cloth is from where it comes to rest, where its motion is chaotic",
            "core/reference: springs in explicit steps, from perturbed starts");

}  // namespace taut
