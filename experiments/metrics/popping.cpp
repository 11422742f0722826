#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

class Popping final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {"popping.max", kAcceleration,
       "max(0, |x_n - 2 x_(n-1) + x_(n-2)|/dt^2 - g) of the free vertices, largest in the last "
       "second"},
      {"popping.peak", kAcceleration, "the same, largest over the run; an impact counts, as 1/dt",
       false, Window::run},
  };
  static bool measures(const Scene& scene) { return !free_vertices(scene).empty(); }
  explicit Popping(const Scene& scene)
      : free_(free_vertices(scene)), dt_(scene.dt), g_(scene.gravity.norm()), end_(scene) {}

  void observe(const Snapshot& m) override {
    if (m.step >= 2) {
      double square = 0;
      for (const std::size_t i : free_)
        square = std::max(square, (m.state.x[i] - 2 * last_[i] + before_[i]).squaredNorm());
      const double pop = std::max(0.0, std::sqrt(square) / (dt_ * dt_) - g_);
      pop_.add(m.step, end_.contains(m.step), pop);
    }
    before_.swap(last_);
    last_ = m.state.x;
  }
  std::vector<double> finish() override { return {pop_.max(), pop_.peak()}; }
  std::vector<double> now(const Snapshot&) const override {
    return {Summary::kNone, Summary::kNone};
  }

 private:
  std::vector<std::size_t> free_;
  double dt_, g_;
  LastSecond end_;
  std::vector<Vec3> last_, before_;  ///< positions one and two steps ago
  Summary pop_;
};

}  // namespace

TAUT_METRIC(popping, Popping, "Sudden jumps of single vertices, as contact=halt makes them",
            "second difference of the positions, beyond gravity's own");

}  // namespace taut
