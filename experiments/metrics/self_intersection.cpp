#include "core/model/crossings.hpp"
#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

class SelfIntersection final : public Metric {
 public:
  /// Distance of faces that coincide, in radii.
  static constexpr double kCoincident = 0.01;
  static constexpr int kMoments = 20;  ///< of the run, at which faces are tested

  static inline const ValueSpec kValues[] = {
      {.name = "self.crossings",
       .unit = kErrorCount,
       .help = lasting("pairs of faces that share no vertex and cross, or coincide (nearer than " +
                       percent(kCoincident) +
                       " of the radius, since layers in one plane do not cross), at the end"),
       .in_series = true,
       .window = Window::end,
       .title = "crossing faces",
       .kept = true},
      {"self.crossings.max", kErrorCount,
       lasting("the same, largest of " + LastSecond::samples_text() + " of the last second")},
      {"self.crossings.peak", kErrorCount,
       lasting("the same, largest of these and of " + std::to_string(kMoments) +
               " moments of the run"),
       false, Window::run},
      {"self.gap", kSignedLength,
       lasting("least of (distance - min(2 radius, distance at rest)) over pairs of vertices, at "
               "most 0: how far the particles' balls overlap, worst of " +
               LastSecond::samples_text() + " of the last second"),
       true},
      {.name = "self.contour",
       .unit = kErrorLength,
       .help = "length of the lines along which faces that share no vertex cross, at the end",
       .in_series = true,
       .window = Window::end,
       .title = "length of intersections"},
  };
  static bool measures(const Scene& scene) { return scene.self_collision.has_value(); }
  explicit SelfIntersection(const Scene& scene)
      : faces_(scene.mesh.triangles),
        rest_(scene.mesh.rest),
        radius_(scene.self_collision->radius),
        steps_(scene.steps),
        end_(scene) {}

  void observe(const Snapshot& m) override {
    const bool at_end = end_.samples(m.step);
    if (!at_end && m.step % std::max(1, steps_ / kMoments) != 0) return;
    const Crossings found = crossed(m.state.x);
    count_.add(m.step, at_end, found.pairs);
    if (m.step == steps_) final_ = found;
    if (at_end) overlap_.add(m.step, true, -least_gap(m.state.x, rest_, radius_));
  }
  std::vector<double> finish() override {
    return {final_.pairs, count_.max(), count_.peak(), 0 - overlap_.max(), final_.length};
  }
  std::vector<double> now(const Snapshot& m) const override {
    const Crossings found = crossed(m.state.x);
    return {found.pairs, Summary::kNone, Summary::kNone, least_gap(m.state.x, rest_, radius_),
            found.length};
  }

 private:
  struct Crossings {
    /// Length [m]: coincident pairs have none.
    double pairs = Summary::kNone, length = Summary::kNone;
  };
  Crossings crossed(const std::vector<Vec3>& x) const {
    const auto crossing = crossings(faces_, x);
    return {static_cast<double>(crossing.size() +
                                coincidences(faces_, x, kCoincident * radius_).size()),
            contour_length(faces_, x, crossing)};
  }
  std::vector<Triangle> faces_;
  std::vector<Vec3> rest_;
  double radius_;
  int steps_;
  LastSecond end_;
  Crossings final_;
  Summary count_, overlap_;
};

}  // namespace

TAUT_METRIC(self_intersection, SelfIntersection, "Whether the cloth passes through itself",
            "triangle pairs by orientation tests and by distance");

}  // namespace taut
