#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// Gap of seams. They have no strain, because their rest length is 0, so the open length is given
/// in metres.
class Seam final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {"seam.gap", kErrorLength,
       "largest distance between two vertices that a seam draws together, mean over the last "
       "second",
       true, Window::last_second, "widest gap of the seams"},
      {"seam.gap.peak", kErrorLength, "the same, at its largest in the last second", false,
       Window::last_second, "widest gap of the seams, at its largest"},
  };
  static bool measures(const Scene& scene) { return std::ranges::any_of(scene.links, is_seam); }
  explicit Seam(const Scene& scene) : end_(scene) {
    std::ranges::copy_if(scene.links, std::back_inserter(seams_), is_seam);
  }

  void observe(const Snapshot& m) override {
    gap_.add(m.step, end_.contains(m.step), widest(m.state));
  }
  std::vector<double> finish() override { return {gap_.mean(), gap_.max()}; }
  std::vector<double> now(const Snapshot& m) const override {
    return {widest(m.state), Summary::kNone};
  }

 private:
  double widest(const State& state) const {
    double gap = 0;
    for (const Link& seam : seams_)
      gap = std::max(gap, (state.x[to_index(seam.b)] - state.x[to_index(seam.a)]).norm());
    return gap;
  }
  std::vector<Link> seams_;
  LastSecond end_;
  Summary gap_;
};

}  // namespace

TAUT_METRIC(seam, Seam, "How far seams are open", "distance between the two vertices");

}  // namespace taut
