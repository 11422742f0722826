#include "core/model/index.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

double area(const Triangle& t, const std::vector<Vec3>& x) {
  const Vec3& a = x[to_index(t[0])];
  const Vec3& b = x[to_index(t[1])];
  const Vec3& c = x[to_index(t[2])];
  return (b - a).cross(c - a).norm() / 2;
}

class Area final : public Metric {
 public:
  static constexpr ValueSpec kValues[] = {
      {"area.rms", kErrorShare,
       "area strain A/A0 - 1 of the faces, RMS over faces and the last second", true},
      {"area.max", kErrorShare, "largest growth of a face in the last second", true},
      {"area.loss", kErrorShare, "largest loss of area of a face in the last second (1: collapsed)",
       true},
      {"area.total", kSignedShare, "area strain of the whole cloth, mean over the last second",
       true},
  };
  static bool measures(const Scene& scene) { return !scene.mesh.triangles.empty(); }
  explicit Area(const Scene& scene) : faces_(scene.mesh.triangles), end_(scene) {
    for (const Triangle& face : faces_) rest_.push_back(area(face, scene.mesh.rest));
  }

  void observe(const Snapshot& m) override {
    const bool at_end = end_.contains(m.step);
    const Strains s = measure(m.state);
    square_.add(m.step, at_end, s.mean_square);
    growth_.add(m.step, at_end, s.growth);
    loss_.add(m.step, at_end, s.loss);
    total_.add(m.step, at_end, s.total);
  }
  std::vector<double> finish() override {
    return {std::sqrt(square_.mean()), growth_.max(), loss_.max(), total_.mean()};
  }
  std::vector<double> now(const Snapshot& m) const override {
    const Strains s = measure(m.state);
    return {std::sqrt(s.mean_square), s.growth, s.loss, s.total};
  }

 private:
  struct Strains {
    double mean_square = 0, growth = 0, loss = 0, total = 0;
  };
  Strains measure(const State& state) const {
    Strains s;
    double sum = 0, sum0 = 0;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const double a = area(faces_[f], state.x), e = a / rest_[f] - 1;
      s.mean_square += e * e / static_cast<double>(faces_.size());
      s.growth = std::max(s.growth, e);
      s.loss = std::max(s.loss, -e);
      sum += a;
      sum0 += rest_[f];
    }
    s.total = sum / sum0 - 1;
    return s;
  }

  std::vector<Triangle> faces_;
  std::vector<double> rest_;  ///< [faces] m^2
  LastSecond end_;
  Summary square_, growth_, loss_, total_;
};

}  // namespace

TAUT_METRIC(area, Area, "Area strain, which shows a collapse in shear that strains no link",
            "A/A0 - 1 of each face");

}  // namespace taut
