#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

class Settle final : public Metric {
 public:
  static constexpr double kSpeed = 5e-3, kWay = 5e-4;  ///< m/s, m

  static inline const ValueSpec kValues[] = {
      {.name = "settle.time",
       .unit = kTime,
       .help = lasting("time after which no free vertex is faster than " + as_typed(1e3 * kSpeed) +
                       " mm/s or goes further than " + as_typed(1e3 * kWay) +
                       " mm from where it was then; the duration if one still does at the end"),
       .window = Window::run,
       .kept = true},
  };
  static bool measures(const Scene& scene) {
    return !scene.gravity.isZero(0) && !free_vertices(scene).empty();
  }
  explicit Settle(const Scene& scene) : free_(free_vertices(scene)) {}

  void observe(const Snapshot& m) override {
    // The speed at the start is the scene's, often 0 by construction.
    if (m.step > 0 && rests(m.state)) return;
    since_ = m.t;
    place_ = m.state.x;
  }
  std::vector<double> finish() override { return {since_}; }
  std::vector<double> now(const Snapshot&) const override { return {Summary::kNone}; }

 private:
  bool rests(const State& s) const {
    return std::ranges::all_of(free_, [&](std::size_t i) {
      return s.v[i].squaredNorm() <= kSpeed * kSpeed &&
             (s.x[i] - place_[i]).squaredNorm() <= kWay * kWay;
    });
  }

  std::vector<std::size_t> free_;
  double since_ = 0;         ///< s
  std::vector<Vec3> place_;  ///< positions of the vertices at that time
};

}  // namespace

TAUT_METRIC(settle, Settle, "When the cloth comes to rest",
            "thresholds of GAUGE's longest stationary duration; compare 8 N^2 dt/(pi^2 k) of k "
            "Gauss-Seidel sweeps on N links");

}  // namespace taut
