#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// The cloth rests if its RMS strain stays within this share of its mean in the last second.
constexpr double kRests = 0.02;
/// A sheet of springs of more vertices takes longer than a tenth of a second to solve.
constexpr int kMostVertices = 5000;

class Predicted final : public Metric {
 public:
  static inline const ValueSpec kValues[] = {
      {.name = kPredicted,
       .unit = kShare,
       .help = lasting(
           "stretch.rms as a law has it that knows the scene and the solver's sweeps alone (`taut "
           "predict`); compare it with stretch.rms, which is measured. No value in motion (if the "
           "RMS stretch varies by more than " +
           percent(kRests) +
           " in the last second), in contact, beyond what the law holds for, or with more than " +
           std::to_string(kMostVertices) + " vertices"),
       .window = Window::none,
       .title = "predicted RMS stretch"},
  };
  static bool measures(const Scene& scene) {
    return !scene.gravity.isZero(0) && !scene.pins.empty() && scene.colliders.empty() &&
           scene.mesh.size() <= kMostVertices;
  }
  explicit Predicted(const Scene& scene) : end_(scene) {
    for (const Link& l : scene.links)
      if (l.family != Family::bend && !is_seam(l) &&
          !(is_pinned(scene, l.a) && is_pinned(scene, l.b)))
        links_.push_back(l);
  }

  void declare(const DeclaredStep& step) override { law_ = step.stretch_at_rest; }
  void observe(const Snapshot& m) override {
    if (!law_ || !end_.samples(m.step)) return;
    const double now = rms(m.state);
    if (count_++ == 0) least_ = most_ = now;
    least_ = std::min(least_, now);
    most_ = std::max(most_, now);
  }
  std::vector<double> finish() override { return {law_ && rests() ? law_() : Summary::kNone}; }
  std::vector<double> now(const Snapshot&) const override { return {Summary::kNone}; }

 private:
  bool rests() const { return count_ > 0 && most_ - least_ <= kRests * (most_ + least_) / 2; }
  double rms(const State& s) const {
    double sum = 0;
    for (const Link& l : links_) {
      const double e = (s.x[to_index(l.b)] - s.x[to_index(l.a)]).norm() / l.rest - 1;
      sum += e * e;
    }
    return std::sqrt(sum / static_cast<double>(links_.size()));
  }

  std::vector<Link> links_;
  LastSecond end_;
  std::function<double()> law_;
  double least_ = 0, most_ = 0;
  int count_ = 0;
};

}  // namespace

TAUT_METRIC(predicted, Predicted, "What the sweeps leave at rest, predicted without the run",
            "core/reference/strain_at_rest.hpp: sweeps are springs");

}  // namespace taut
