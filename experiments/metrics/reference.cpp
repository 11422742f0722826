#include "experiments/metrics/reference.hpp"

#include <cmath>

#include "core/model/index.hpp"
#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/metrics/reference_path.hpp"

namespace taut {

namespace {

class Distance final : public Metric {
 public:
  static inline const ValueSpec kValues[] = {
      {.name = "reference.rms",
       .unit = kErrorLength,
       .help = "distance of the free vertices from the static reference, RMS over vertices and "
               "the last second",
       .in_series = true,
       .title = "distance from the reference (RMS)",
       .role = Role::reference_error,
       .floor = {"reference.floor", "the reference's own error"}},
      {"reference.max", kErrorLength,
       "largest distance of a free vertex from the static reference, in the last second", true,
       Window::last_second, "largest distance from the reference"},
      {"reference.floor", kLength, "the static reference's own error, by self-convergence", false,
       Window::none},
      {"reference.strain", kShare,
       "largest strain |d - r|/r of a structural or shear link in the static reference itself",
       false, Window::none},
      {.name = "motion.share",
       .unit = kSignedShare,
       .help = lasting(
           "share of the reference's motion that the cloth makes: sum of (cloth's move . "
           "reference's move) over the sum of the reference's squared, over the free vertices' "
           "moves from each moment of the dynamic reference to the next. 0 if the cloth stands "
           "still; no value where motion.error has none"),
       .window = Window::none,
       .title = "share of the way travelled",
       .role = Role::motion},
      {.name = kMotionError,
       .unit = kErrorShare,
       .help = lasting(
           "distance of the free vertices from the dynamic reference, RMS over its moments and "
           "over the vertices by mass, relative to that of a cloth that stands still (it goes "
           "where its pins go or, without pins, falls): 0 for the reference, 1 for such a cloth. "
           "No value if the reference hardly moves, less than " +
           percent(ReferencePath::kLeastWay) + " of the cloth's size"),
       .window = Window::none,
       .title = "distance from the reference in motion, per way",
       .role = Role::motion_error,
       .negligible = 1e-2,
       .floor = {"motion.floor", "how far references that should agree differ"}},
      {.name = kMotionFloor,
       .unit = kShare,
       .help = "largest motion.error of one reference beside another that should agree with it: "
               "shorter steps, a start that differs by 1e-6 of the cloth's size, another program",
       .window = Window::none},
      {.name = kMotionStrain,
       .unit = kShare,
       .help =
           "stretch.rms of the dynamic reference itself, over its moments in the last second of "
           "the run; about 0 where the links are rigid",
       .window = Window::none},
      {.name = "motion.phase",
       .unit = kTime,
       .help =
           lasting("time shift that brings the cloth nearest to the dynamic reference; positive "
                   "if the cloth is late; at most " +
                   percent(ReferencePath::kLongestShift) +
                   " of the horizon, over the moments that are at least that far from its ends. No "
                   "value if the cloth makes less than half of the motion"),
       .window = Window::none,
       .title = "phase behind the reference in motion"},
      {.name = "motion.horizon",
       .unit = kTime,
       .help = "last moment of the dynamic reference that the run reached; beyond the reference, "
               "motion is chaotic or was not computed",
       .window = Window::none,
       .title = "horizon of the reference in motion"},
  };
  Distance(const Scene& scene, References known)
      : free_(free_vertices(scene)), known_(std::move(known)), end_(scene) {
    if (known_.motion) path_.emplace(scene, std::move(*known_.motion));
    if (!known_.rest) return;
    strain_ = 0;
    for (const Link& link : scene.links)
      if (link.family != Family::bend && !is_seam(link)) {
        const Vec3 delta = known_.rest->x[to_index(link.b)] - known_.rest->x[to_index(link.a)];
        strain_ = std::max(strain_, std::abs(delta.norm() - link.rest) / link.rest);
      }
  }

  void observe(const Snapshot& m) override {
    if (known_.rest && end_.contains(m.step)) {
      const Gap gap = from(*known_.rest, m.state);
      rms_.add(m.step, true, gap.mean_square);
      max_.add(m.step, true, gap.max);
    }
    if (path_) path_->observe(m);
  }
  std::vector<double> finish() override {
    return {std::sqrt(rms_.mean()),
            max_.max(),
            known_.rest ? known_.rest->floor : Summary::kNone,
            strain_,
            of_path(&ReferencePath::share),
            of_path(&ReferencePath::error),
            of_path(&ReferencePath::floor),
            of_path(&ReferencePath::strain),
            of_path(&ReferencePath::phase),
            of_path(&ReferencePath::horizon)};
  }
  std::vector<double> now(const Snapshot& m) const override {
    std::vector<double> values(std::size(kValues), Summary::kNone);
    if (!known_.rest) return values;
    const Gap gap = from(*known_.rest, m.state);
    values[0] = std::sqrt(gap.mean_square);
    values[1] = gap.max;
    return values;
  }

 private:
  struct Gap {
    double mean_square = 0, max = 0;  ///< m^2, m
  };
  Gap from(const Reference& reference, const State& state) const {
    Gap gap;
    for (const std::size_t i : free_) {
      const double distance2 = (state.x[i] - reference.x[i]).squaredNorm();
      gap.mean_square += distance2 / static_cast<double>(free_.size());
      gap.max = std::max(gap.max, std::sqrt(distance2));
    }
    return gap;
  }
  double of_path(double (ReferencePath::*value)() const) const {
    return path_ ? (*path_.*value)() : Summary::kNone;
  }
  std::vector<std::size_t> free_;
  References known_;
  std::optional<ReferencePath> path_;
  LastSecond end_;
  Summary rms_, max_;
  double strain_ = Summary::kNone;
};

}  // namespace

/// Reads the references once.
template <>
std::unique_ptr<Metric> make_metric<Distance>(const Scene& scene) {
  References known = known_references(scene);
  if (!known.rest && !known.motion) return nullptr;
  return std::make_unique<Distance>(scene, std::move(known));
}

TAUT_METRIC(reference, Distance, "How far the cloth is from where it should be",
            "core/reference: static equilibrium; SHAKE; springs in explicit steps");

}  // namespace taut
