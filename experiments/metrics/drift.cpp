#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

class Drift final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {"drift.max", kLength,
       "largest distance of the centre of mass from its start over the run (pinned vertices "
       "included)",
       false, Window::run},
      {"drift.mean", kLength, "its distance from its start, mean over the last second", true},
  };
  explicit Drift(const Scene& scene) : mass_(scene.mesh.mass), end_(scene) {}

  void observe(const Snapshot& m) override {
    if (m.step == 0) start_ = mean(mass_, m.state.x);
    distance_.add(m.step, end_.contains(m.step), (mean(mass_, m.state.x) - start_).norm());
  }
  std::vector<double> finish() override { return {distance_.peak(), distance_.mean()}; }
  std::vector<double> now(const Snapshot& m) const override {
    return {Summary::kNone, (mean(mass_, m.state.x) - start_).norm()};
  }

 private:
  std::vector<double> mass_;
  LastSecond end_;
  Vec3 start_ = Vec3::Zero();
  Summary distance_;
};

}  // namespace

TAUT_METRIC(drift, Drift, "How far the centre of mass moves", "sum of m x over sum of m");

}  // namespace taut
