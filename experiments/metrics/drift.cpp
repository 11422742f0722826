#include "experiments/metrics/summary.hpp"

namespace taut::metric::drift {

namespace {

constexpr ValueSpec kValues[] = {
    {"drift.max", kLength,
     "largest distance of the centre of mass from its start over the run (pinned vertices "
     "included)",
     false, Window::run},
    {"drift.mean", kLength, "its distance from its start, mean over the last second", true},
};

class Drift final : public Metric {
 public:
  explicit Drift(const Scene& scene) : mass_(scene.mesh.mass), end_(scene) {}

  void observe(const Snapshot& m) override {
    if (m.step == 0) start_ = center(m.state);
    distance_.add(m.step, end_.contains(m.step), (center(m.state) - start_).norm());
  }
  std::vector<double> finish() override { return {distance_.peak(), distance_.mean()}; }
  std::vector<double> now(const Snapshot& m) const override {
    return {Summary::kNone, (center(m.state) - start_).norm()};
  }

 private:
  Vec3 center(const State& state) const {
    Vec3 sum = Vec3::Zero();
    double total = 0;
    for (std::size_t i = 0; i < mass_.size(); ++i) sum += mass_[i] * state.x[i], total += mass_[i];
    return sum / total;
  }
  std::vector<double> mass_;
  LastSecond end_;
  Vec3 start_ = Vec3::Zero();
  Summary distance_;
};

}  // namespace
}  // namespace taut::metric::drift

TAUT_METRIC(drift) = {.name = "drift",
                      .summary = "How far the centre of mass moves",
                      .source = "sum of m x over sum of m",
                      .values = taut::metric::drift::kValues,
                      .make = [](const taut::Scene& scene) -> std::unique_ptr<taut::Metric> {
                        return std::make_unique<taut::metric::drift::Drift>(scene);
                      }};
