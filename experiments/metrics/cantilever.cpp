#include <cmath>
#include <numbers>

#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"

namespace taut {

namespace {

/// A level sheet that is held by its first two rows alone; its clamp is midway between them.
class Cantilever final : public Metric {
 public:
  static constexpr Unit kDegrees{Unit::Kind::other, "rad", "\u00B0", 180 / std::numbers::pi, false};
  static constexpr double kMost = std::numbers::pi / 3;  ///< rad, limit of Peirce's formula
  static inline const ValueSpec kValues[] = {
      {.name = "cantilever.angle",
       .unit = kDegrees,
       .help = "angle below the horizontal at which the clamp sees the middle of the last row, "
               "mean over the last second; has a value if the sheet starts across gravity and its "
               "first two rows are pinned: the clamp is midway between them",
       .in_series = true,
       .title = "angle of a cantilever"},
      {.name = "cantilever.bending_length",
       .unit = kLength,
       .help = lasting(
           "Peirce's bending length (B/w)^(1/3) from that angle and the overhang L: L "
           "(cos(angle/2)/(8 tan(angle)))^(1/3), too long by 0.4 % at 20 degrees, 1.9 % at 41.5, "
           "4.4 % at 60, 57 % at 87; no value beyond " +
           as_typed(std::round(kMost * kDegrees.scale)) + " degrees, where the formula fails"),
       .title = "bending length"}};
  static bool measures(const Scene& scene) {
    if (!scene.mesh.grid || scene.mesh.grid->nv < 3 || scene.gravity.isZero(0)) return false;
    const Cantilever c(scene);
    const int clamped = 2 * scene.mesh.grid->nu;
    return scene.releases.empty() && static_cast<int>(scene.pins.size()) == clamped &&
           scene.pins.back() == clamped - 1 && std::abs(c.out_.dot(c.down_)) < 1e-3 &&
           scene.colliders.empty();
  }
  explicit Cantilever(const Scene& scene)
      : grid_(*scene.mesh.grid), down_(scene.gravity.normalized()), end_(scene) {
    const Vec3 out = end_of(scene.mesh.rest);
    overhang_ = out.norm();
    out_ = out / overhang_;
  }

  void observe(const Snapshot& m) override { angle_.add(m.step, end_.contains(m.step), now(m)[0]); }
  std::vector<double> finish() override {
    const double angle = angle_.mean();
    if (!(angle > 0 && angle <= kMost)) return {angle, Summary::kNone};
    return {angle, overhang_ * std::cbrt(std::cos(angle / 2) / (8 * std::tan(angle)))};
  }
  std::vector<double> now(const Snapshot& m) const override {
    const Vec3 end = end_of(m.state.x);
    return {std::atan2(end.dot(down_), end.dot(out_)), Summary::kNone};
  }

 private:
  /// Position of the middle of the last row, from the clamp.
  Vec3 end_of(const std::vector<Vec3>& x) const {
    const auto row = [&](int j) {
      Vec3 sum = Vec3::Zero();
      for (int i = 0; i < grid_.nu; ++i) sum += x[to_index(grid_.index(i, j))];
      return Vec3(sum / grid_.nu);
    };
    return row(grid_.nv - 1) - (row(0) + row(1)) / 2;
  }

  Grid grid_;
  Vec3 down_, out_ = Vec3::Zero();
  double overhang_ = 0;  ///< m
  LastSecond end_;
  Summary angle_;
};

}  // namespace

TAUT_METRIC(cantilever, Cantilever, "How far a clamped strip bends down: its bending length",
            "Peirce 1930; ISO 9073-7, ASTM D1388");

}  // namespace taut
