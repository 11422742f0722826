#include "experiments/case/computed_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "core/model/pin_places.hpp"
#include "core/model/text.hpp"
#include "experiments/case/record.hpp"

namespace taut {

namespace {

std::vector<Vec3> converted(std::vector<Vec3> x, double scale, bool z_up) {
  for (Vec3& v : x) v = scale * (z_up ? Vec3(v.x(), v.z(), -v.y()) : v);
  return x;
}

/// The number of decimals to which all coordinates are rounded; more than 15: to none.
int decimals(const std::vector<Vec3>& x) {
  int digits = 0;
  double power = 1;
  for (const Vec3& v : x)
    for (const double c : v)
      while (digits < 16 && std::abs(c * power - std::round(c * power)) > 1e-15 * power + 1e-9) {
        ++digits;
        power *= 10;
      }
  return digits;
}

/// Distance between neighbouring numbers that the file can hold at c, in the file's unit.
double spacing(double c, Rounding rounding, int digits) {
  if (rounding == Rounding::decimal && digits < 16) return std::pow(10, -digits);
  const double size = std::abs(c), infinity = std::numeric_limits<double>::infinity();
  if (rounding != Rounding::binary32) return std::nextafter(size, infinity) - size;
  const auto single = static_cast<float>(size);
  return static_cast<double>(std::nextafter(single, std::numeric_limits<float>::infinity()) -
                             single);
}

/// Pairs of a file's vertices and the scene's.
struct VertexMatch {
  std::vector<std::size_t> of_scene;  ///< [n] the file's vertex that is the scene's i-th
  double farthest = 0;                ///< m, largest distance of a pair
  std::string mismatch;               ///< why there are no pairs, one sentence; "": there are
  bool same_order() const { return std::ranges::is_sorted(of_scene); }
};

constexpr std::size_t kNoVertex = std::numeric_limits<std::size_t>::max();

std::string coordinates(const Vec3& x) {
  return "(" + general(x.x(), 6) + ", " + general(x.y(), 6) + ", " + general(x.z(), 6) + ")";
}

/// Vertices in the order of their x.
class Neighbours {
 public:
  explicit Neighbours(const std::vector<Vec3>& all) : all_(all), order_(all.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::ranges::sort(order_, {}, [&](std::size_t i) { return all_[i].x(); });
  }

  /// The nearest vertex within `radius`; kNoVertex: there is none.
  std::size_t within(const Vec3& x, double radius) const {
    std::size_t best = kNoVertex;
    auto at = std::ranges::lower_bound(order_, x.x() - radius, {},
                                       [&](std::size_t i) { return all_[i].x(); });
    for (; at != order_.end() && all_[*at].x() <= x.x() + radius; ++at)
      if (const double d = (all_[*at] - x).norm(); d <= radius) {
        radius = d;
        best = *at;
      }
    return best;
  }

 private:
  const std::vector<Vec3>& all_;
  std::vector<std::size_t> order_;
};

/// Pairs vertices that lie within `tolerance` [m] of each other: those of the same number if this
/// fits for all, else the nearest ones. O(n log n) unless many vertices share their x.
VertexMatch match_vertices(const std::vector<Vec3>& file, const std::vector<Vec3>& scene,
                           double tolerance) {
  VertexMatch match;
  if (file.size() != scene.size()) {
    match.mismatch = "it has " + std::to_string(file.size()) + " vertices, the scene has " +
                     std::to_string(scene.size());
    return match;
  }
  for (std::size_t i = 0; i < file.size(); ++i)
    if (!file[i].allFinite()) {
      match.mismatch = "its vertex " + std::to_string(i) + " begins at " + coordinates(file[i]);
      return match;
    }
  match.of_scene.resize(file.size());
  std::iota(match.of_scene.begin(), match.of_scene.end(), std::size_t{0});
  const auto farthest = [&] {
    double d = 0;
    for (std::size_t i = 0; i < scene.size(); ++i)
      d = std::max(d, (file[match.of_scene[i]] - scene[i]).norm());
    return d;
  };
  match.farthest = farthest();
  if (match.farthest <= tolerance) return match;

  match.of_scene.assign(file.size(), kNoVertex);
  const Neighbours neighbours(scene);
  std::size_t strays = 0, first_stray = kNoVertex;
  for (std::size_t i = 0; i < file.size(); ++i) {
    const std::size_t same = neighbours.within(file[i], tolerance);
    if (same == kNoVertex) {
      ++strays;
      first_stray = std::min(first_stray, i);
    } else if (match.of_scene[same] != kNoVertex) {
      match.mismatch = "its vertices " + std::to_string(match.of_scene[same]) + " and " +
                       std::to_string(i) + " both lie on the scene's vertex " +
                       std::to_string(same) + " " + coordinates(scene[same]);
      return match;
    } else {
      match.of_scene[same] = i;
    }
  }
  if (strays > 0) {
    const std::size_t at =
        neighbours.within(file[first_stray], std::numeric_limits<double>::infinity());
    match.mismatch = std::to_string(strays) + " of its " + std::to_string(file.size()) +
                     " vertices lie on none of the scene: its vertex " +
                     std::to_string(first_stray) + " is at " + coordinates(file[first_stray]) +
                     ", " + general((scene[at] - file[first_stray]).norm(), 4) +
                     " m from the nearest, the scene's vertex " + std::to_string(at) + " at " +
                     coordinates(scene[at]) + " (tolerance " + general(tolerance, 2) + " m)";
    return match;
  }
  match.farthest = farthest();
  return match;
}

/// Largest distance [m] of a file's vertex from the scene's.
double tolerance(const Scene& scene) { return 1e-4 * extent(scene); }

/// Plays a motion as a solver would compute it.
class Playback final : public Solver {
 public:
  Playback(const Scene& scene, ComputedFrames frames) : motion_(scene, std::move(frames)) {
    if (!motion_.misfits().empty()) throw InputError(motion_.misfits().front());
  }
  void load(const State& state) override { state_ = state; }
  void step(double t, double dt) override {
    std::vector<Vec3> next = motion_.frame(static_cast<int>(std::lround(t / dt)) + 1);
    for (std::size_t i = 0; i < next.size(); ++i) state_.v[i] = (next[i] - state_.x[i]) / dt;
    state_.x = std::move(next);
  }
  void store(State& state) const override { state = state_; }
  std::vector<PassCost> step_cost() const override { return {}; }
  double cpu_seconds() const override { return std::numeric_limits<double>::quiet_NaN(); }
  std::size_t peak_bytes() const override { return 0; }
  std::string time_remark() const override { return "positions from a file: cost not measured"; }

 private:
  ComputedMotion motion_;
  State state_;
};

}  // namespace

ComputedMotion::ComputedMotion(const Scene& scene, ComputedFrames frames)
    : frames_(std::move(frames)),
      frame_dt_(frames_.fps > 0 ? header().spacing / frames_.fps : scene.dt) {
  find_place(scene);
  if (std::abs(frame_dt_ - scene.dt) > 1e-6 * scene.dt)
    misfits_.push_back(frames_.name + " has a frame each " + shortest(frame_dt_) +
                       " s, the scene a step each " + shortest(scene.dt) +
                       " s: --dt (time.dt in a study) makes them agree");
  if (header().frames <= scene.steps)
    misfits_.push_back(frames_.name + " has " + std::to_string(header().frames) +
                       " frames, the scene needs " + std::to_string(scene.steps + 1) +
                       ": --duration (time.duration in a study) makes it shorter");
  if (misfits_.empty()) check_pins(scene);
}

void ComputedMotion::find_place(const Scene& scene) {
  const bool at_rest = frames_.rest != nullptr;
  const std::vector<Vec3> first = (at_rest ? frames_.rest : frames_.positions)->read(0);
  VertexMatch match = match_vertices(converted(first, frames_.scale, frames_.z_up),
                                     at_rest ? scene.mesh.rest : scene.start.x, tolerance(scene));
  if (!match.mismatch.empty()) {
    misfits_.push_back((at_rest
                            ? frames_.rest_name + " is not " + scene.name + " at rest, at "
                            : frames_.name + " does not begin as " + scene.name + " does, at ") +
                       place() + ": " + match.mismatch);
    return;
  }
  order_said_ = std::string(match.same_order() ? "as in the scene" : "matched by position") +
                ", at " + (at_rest ? "rest" : "the start") + " at most " +
                general(match.farthest, 2) + " m off";
  of_scene_ = std::move(match.of_scene);
}

void ComputedMotion::check_pins(const Scene& scene) {
  if (scene.pins.empty()) return;
  const PinPlaces pins(scene);
  PinPlaces::Stray farthest;
  double when = 0;
  for (int k = 0; k <= scene.steps; ++k)
    if (const auto stray = pins.farthest(k, frame(k), tolerance(scene), 0);
        stray.distance > farthest.distance) {
      farthest = stray;
      when = k * scene.dt;
    }
  if (farthest.vertex >= 0)
    misfits_.push_back(frames_.name + " does not hold the scene's pins: " + said(farthest, when));
}

std::string ComputedMotion::place() const {
  return "1 unit is " + shortest(frames_.scale) + " m, " + (frames_.z_up ? "z" : "y") + " up";
}

std::vector<Vec3> ComputedMotion::frame(int k) {
  const std::vector<Vec3> x = converted(frames_.positions->read(k), frames_.scale, frames_.z_up);
  std::vector<Vec3> ordered;
  ordered.reserve(x.size());
  for (const std::size_t i : of_scene_) ordered.push_back(x[i]);
  return ordered;
}

State ComputedMotion::start(const Scene& scene) {
  State first{frame(0), scene.start.v};
  const std::vector<Vec3> next = frame(1);
  bool later = false;
  for (std::size_t i = 0; i < next.size(); ++i) {
    later = later || (first.x[i] - scene.start.x[i]).norm() > tolerance(scene);
    if (next[i].allFinite()) first.v[i] = (next[i] - first.x[i]) / scene.dt;
  }
  return later ? first : scene.start;
}

StrainFloor ComputedMotion::floor(const Scene& scene) {
  std::vector<Vec3> x = frame(scene.steps);
  if (!std::ranges::all_of(x, [](const Vec3& v) { return v.allFinite(); })) x = frame(0);
  const Rounding rounding = header().rounding;
  const double scale = frames_.scale;
  const int digits = rounding == Rounding::decimal ? decimals(converted(x, 1 / scale, false)) : 0;
  StrainFloor floor;
  double sum = 0;
  for (const Link& link : scene.links) {
    if (is_seam(link)) continue;
    const Vec3 &a = x[to_index(link.a)], &b = x[to_index(link.b)];
    const Vec3 along = (b - a).normalized();
    double variance = 0, most = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const double c : {a[axis], b[axis]}) {
        const double step = scale * spacing(c / scale, rounding, digits) * std::abs(along[axis]);
        variance += step * step / 12;  // of a rounding that is as likely anywhere in the step
        most += step / 2;
      }
    sum += variance / (link.rest * link.rest);
    floor.max = std::max(floor.max, most / link.rest);
  }
  if (!scene.links.empty()) floor.rms = std::sqrt(sum / static_cast<double>(scene.links.size()));
  return floor;
}

ResolvedSettings ComputedMotion::settings(const Scene& scene) {
  const PositionsHeader& about = header();
  const StrainFloor least = floor(scene);
  const char* rounding = about.rounding == Rounding::binary32   ? "float32"
                         : about.rounding == Rounding::binary64 ? "float64"
                                                                : "text";
  return {
      {"frames", std::to_string(about.frames) + " of " + std::to_string(about.vertices) +
                     " vertices, " + rounding +
                     (about.frames > scene.steps + 1
                          ? "; scored are the first " + std::to_string(scene.steps + 1) +
                                ", with which the scene ends"
                          : "")},
      {"time step", shortest(frame_dt_) + " s a frame, " +
                        (frames_.fps > 0 ? "as said" : "assumed: the scene's; fps says otherwise")},
      {"unit", place()},
      {"vertex order", order_said_},
      {kStrainFloor,
       scientific(least.rms, 1) + " RMS, " + scientific(least.max, 1) +
           " at most: the rounding of the file",
       "", least.rms},
      {"velocity", "differences between frames"},
      {"cost", "not measured"}};
}

SolverEntry player(std::function<ComputedFrames(const Params&)> open) {
  return {.name = "positions",
          .summary = "Positions that another program computed: positions:file=mine.npy",
          .source = "experiments/external/FILES.md",
          .make = MakeSolver([open](const Scene& scene,
                                    const Params& params) -> std::unique_ptr<Solver> {
                    return std::make_unique<Playback>(scene, open(params));
                  }).whole(),
          .unsupported =
              [open](const Scene& scene, const Params& params) {
                return ComputedMotion(scene, open(params)).misfits();
              },
          .resolved_settings =
              [open](const Scene& scene, const Params& params) {
                return ComputedMotion(scene, open(params)).settings(scene);
              },
          .start =
              [open](const Scene& scene, const Params& params) {
                return ComputedMotion(scene, open(params)).start(scene);
              },
          .declared_step = implicit_euler_of_a_frame,
          .pins_within = tolerance};
}

SceneSettings fitted(const LoadScene& load, SceneSettings settings, const ComputedFrames& frames) {
  Scene scene = load(settings);
  const ComputedMotion motion(scene, frames);
  if (std::abs(motion.frame_dt() - scene.dt) > 1e-6 * scene.dt) {
    settings.emplace_back("time.dt", shortest(motion.frame_dt()));
    scene = load(settings);
  }
  if (motion.header().frames < 2)
    throw InputError(frames.name +
                     ": has one frame; a motion has two at least, the start and what follows");
  if (const int steps = motion.header().frames - 1; steps < scene.steps)
    settings.emplace_back("time.duration", shortest(steps * motion.frame_dt()));
  return settings;
}

CaseRun score(const Scene& scene, const ComputedFrames& frames, const RunOptions& options) {
  const ComputedMotion motion(scene, frames);
  if (!motion.misfits().empty()) throw InputError(motion.misfits().front());
  const SolverEntry entry = player([&frames](const Params&) { return frames; });
  return run_case(scene, {&entry, Params(entry.name, {}, "")}, options);
}

}  // namespace taut
