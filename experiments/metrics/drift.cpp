#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

constexpr ValueSpec kValues[] = {
    {"drift.max", "m",
     "largest distance of the centre of mass from its start (pinned vertices included)"},
};

class Drift final : public Metric {
 public:
  explicit Drift(const Scene& scene) : mass_(scene.mesh.mass) {}

  void observe(const Moment& m) override {
    const Vec3 c = center(m.state);
    if (m.step == 0) start_ = c;
    max_ = std::max(max_, (c - start_).norm());
  }
  std::vector<double> finish() override { return {max_}; }
  std::vector<double> now(const Moment& m) const override {
    return {(center(m.state) - start_).norm()};
  }

 private:
  Vec3 center(const State& state) const {
    Vec3 sum = Vec3::Zero();
    double total = 0;
    for (std::size_t i = 0; i < mass_.size(); ++i) sum += mass_[i] * state.x[i], total += mass_[i];
    return sum / total;
  }
  std::vector<double> mass_;
  Vec3 start_ = Vec3::Zero();
  double max_ = 0;
};

}  // namespace
}  // namespace taut

TAUT_METRIC(drift) = {.name = "drift",
                      .summary = "How far the centre of mass moves",
                      .source = "sum of m x over sum of m",
                      .values = taut::kValues,
                      .make = [](const taut::Scene& scene) -> std::unique_ptr<taut::Metric> {
                        return std::make_unique<taut::Drift>(scene);
                      }};
