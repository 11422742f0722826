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
      {"reference.motion", kErrorLength,
       "distance of the free vertices from the dynamic reference, RMS over vertices, at its first "
       "moment",
       false, Window::end, "distance from the reference in motion (RMS)"},
      {"reference.floor", kLength, "the static reference's own error, by self-convergence", false,
       Window::none},
      {"reference.strain", kShare,
       "largest strain |d - r|/r of a structural or shear link in the static reference itself",
       false, Window::none},
      {"reference.motion_floor", kLength, "the dynamic reference's own error, by self-convergence",
       false, Window::none},
      {.name = "motion.share",
       .unit = kSignedShare,
       .help = lasting(
           "share of the reference's motion that the cloth makes: sum of (cloth's move . "
           "reference's move) over the sum of the reference's squared, over the free vertices' "
           "moves from each moment of the dynamic reference to the next. 0 if the cloth stands "
           "still; no value if the reference hardly moves, less than " +
           percent(ReferencePath::kLeastWay) + " of the cloth's size"),
       .window = Window::none,
       .title = "share of the way travelled",
       .role = Role::motion},
      {.name = kMotionError,
       .unit = kErrorShare,
       .help = "distance of the free vertices from the dynamic reference at its moments, RMS, over "
               "the reference's distance from the start; 1 if the cloth stands still",
       .window = Window::none,
       .title = "distance from the reference in motion, per way"},
      {.name = "motion.phase",
       .unit = kTime,
       .help = "time shift that brings the cloth nearest to the dynamic reference at its moments; "
               "positive if the cloth is late; at most the time of the first moment, over the "
               "moments at least that long before the end of the run",
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
      : free_(free_vertices(scene)),
        known_(std::move(known)),
        path_(scene, known_.motion),
        end_(scene) {
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
    if (!known_.motion.empty() && std::abs(m.t - known_.motion[0].t) < 1e-6)
      at_moment_ = std::sqrt(from(known_.motion[0], m.state).mean_square);
    path_.observe(m);
  }
  std::vector<double> finish() override {
    return {std::sqrt(rms_.mean()),
            max_.max(),
            at_moment_,
            known_.rest ? known_.rest->floor : Summary::kNone,
            strain_,
            known_.motion.empty() ? Summary::kNone : known_.motion[0].floor,
            path_.share(),
            path_.error(),
            path_.phase(),
            path_.horizon()};
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
  std::vector<std::size_t> free_;
  References known_;
  ReferencePath path_;
  LastSecond end_;
  Summary rms_, max_;
  double strain_ = Summary::kNone;
  double at_moment_ = Summary::kNone;
};

}  // namespace

/// Reads the references once.
template <>
std::unique_ptr<Metric> make_metric<Distance>(const Scene& scene) {
  References known = known_references(scene);
  if (!known.rest && known.motion.empty()) return nullptr;
  return std::make_unique<Distance>(scene, std::move(known));
}

TAUT_METRIC(reference, Distance, "How far the cloth is from where it should be",
            "core/reference: static equilibrium; SHAKE");

}  // namespace taut
