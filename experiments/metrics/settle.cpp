#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

class Settle final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {.name = "settle.time",
       .unit = kTime,
       .help = "last time at which the RMS speed of the free vertices exceeds 1e-3 sqrt(g L); the "
               "duration if it still does at the end; L is the diagonal of the rest shape's "
               "bounding box",
       .window = Window::run,
       .kept = true},
  };
  static bool measures(const Scene& scene) {
    return !scene.gravity.isZero(0) && !free_vertices(scene).empty();
  }
  explicit Settle(const Scene& scene)
      : free_(free_vertices(scene)),
        threshold_square_(1e-6 * scene.gravity.norm() * extent(scene)) {}

  void observe(const Snapshot& m) override {
    if (m.step == 0) return;  // the speed of the start is the scene's, often 0 by construction
    if (!(mean_square_speed(m.state, free_) <= threshold_square_)) last_ = m.t;
  }
  std::vector<double> finish() override { return {last_}; }
  std::vector<double> now(const Snapshot&) const override { return {Summary::kNone}; }

 private:
  std::vector<std::size_t> free_;
  double threshold_square_;  ///< m^2/s^2
  double last_ = 0;          ///< s
};

}  // namespace

TAUT_METRIC(settle, Settle, "When the cloth comes to rest",
            "compare 8 N^2 dt/(pi^2 k) of k Gauss-Seidel sweeps on N links");

}  // namespace taut
