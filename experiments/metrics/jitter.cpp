#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

class Jitter final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {"jitter.rms", kSpeed, "speed of the free vertices, RMS over vertices and the last second",
       true},
      {"jitter.max", kSpeed, "largest speed of a free vertex in the last second", true},
  };
  static bool measures(const Scene& scene) { return !free_vertices(scene).empty(); }
  explicit Jitter(const Scene& scene) : free_(free_vertices(scene)), end_(scene) {}

  void observe(const Snapshot& m) override {
    if (!end_.contains(m.step)) return;
    square_.add(m.step, true, mean_square_speed(m.state, free_));
    fastest_.add(m.step, true, fastest(m.state));
  }
  std::vector<double> finish() override { return {std::sqrt(square_.mean()), fastest_.max()}; }
  std::vector<double> now(const Snapshot& m) const override {
    return {std::sqrt(mean_square_speed(m.state, free_)), fastest(m.state)};
  }

 private:
  double fastest(const State& state) const {
    double square = 0;
    for (const std::size_t i : free_) square = std::max(square, state.v[i].squaredNorm());
    return std::sqrt(square);
  }
  std::vector<std::size_t> free_;
  LastSecond end_;
  Summary square_, fastest_;
};

}  // namespace

TAUT_METRIC(jitter, Jitter, "Motion left in the last second: noise, if the cloth should rest",
            "RMS speed");

}  // namespace taut
