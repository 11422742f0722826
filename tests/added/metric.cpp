// A metric that the rest of the program does not know.
#include "experiments/metrics/metric.hpp"

namespace taut {
namespace {

class Sag final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {.name = "sag.rms",
       .unit = {Unit::Kind::length, "m", "cm", 1e2, true, true},
       .help = "way of the vertices from the start, RMS over vertices and the last second",
       .in_series = true,
       .role = Role::error,
       .negligible = 1e-3,
       .shown_over_time = true,
       .kept = true},
      {.name = "sag.peak",
       .unit = {Unit::Kind::length, "m", "cm", 1e2, true, true},
       .help = "largest way of a vertex from the start over the run",
       .window = Window::run,
       .role = Role::contact_error},
  };
  explicit Sag(const Scene& scene) : start_(scene.start.x), end_(scene) {}

  void observe(const Snapshot& m) override {
    const auto [square, most] = way(m);
    square_.add(m.step, end_.contains(m.step), square);
    most_.add(m.step, false, most);
  }
  std::vector<double> finish() override { return {std::sqrt(square_.mean()), most_.peak()}; }
  std::vector<double> now(const Snapshot& m) const override {
    return {std::sqrt(way(m).first), Summary::kNone};
  }

 private:
  /// Mean square distance from the start [m^2] and largest distance [m].
  std::pair<double, double> way(const Snapshot& m) const {
    double sum = 0, most = 0;
    for (std::size_t i = 0; i < start_.size(); ++i) {
      const double square = (m.state.x[i] - start_[i]).squaredNorm();
      sum += square;
      most = std::max(most, std::sqrt(square));
    }
    return {sum / static_cast<double>(start_.size()), most};
  }
  std::vector<Vec3> start_;  // m
  LastSecond end_;
  Summary square_, most_;
};

}  // namespace

TAUT_METRIC(sag, Sag, "How far the cloth has moved", "distances from the start");

}  // namespace taut
