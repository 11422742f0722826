#include "core/reference/step_error.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "core/model/text.hpp"
#include "core/reference/exact_path.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/metrics/own_way.hpp"

namespace taut {

namespace {

/// Every kEvery-th step is judged, at most kMostSamples of them including the last, and only for at
/// most kMostFree vertices: each judgement takes as long as some forty steps of Jakobsen's solver.
constexpr int kEvery = 16, kMostSamples = 8;
/// Least share of the judged steps that must be believed.
constexpr double kEnough = 0.5;
/// Least displacement of the cloth, as a share of the scene's extent.
constexpr double kLeastWay = 0.05;
/// Largest share of the expected displacement that rounding may seem to miss.
constexpr double kMostRounding = 0.1;
/// Most displacement that the cloth may seem to have missed, in falls from its start.
constexpr double kMostFalls = 2;
/// Number of the first steps in which the displacement is judged.
constexpr int kFirstSamples = 8;

/// RMS rounding of a coordinate relative to it, for an error that is uniform within half a unit in
/// the last place on either side. A state that was computed in single precision has only float
/// coordinates.
double relative_rounding(const std::vector<Vec3>& x) {
  const auto is_float = [](double a) { return static_cast<double>(static_cast<float>(a)) == a; };
  const bool all = std::ranges::all_of(
      x, [&](const Vec3& v) { return is_float(v.x()) && is_float(v.y()) && is_float(v.z()); });
  return (all ? 0x1p-24 : 0x1p-53) / std::sqrt(3.0);
}

/// Upper bound of a cloth's displacement [m] in these seconds, by kMostFalls. Hundreds of substeps
/// in single precision round so much in contact that they may seem to miss more. Infinite without
/// gravity, where nothing is known.
double farthest(const Scene& scene, double seconds) {
  const double g = scene.gravity.norm();
  if (g == 0) return std::numeric_limits<double>::infinity();
  double fastest = 0;
  for (const Vec3& v : scene.start.v) fastest = std::max(fastest, v.norm());
  return kMostFalls * (g * seconds / 2 + fastest) * seconds;
}

/// Error of single steps, from the step that the solver declares and the states alone: the state
/// before a step, or before its last substep, and the state after it.
class StepErrors final : public Metric {
 public:
  static inline const ValueSpec kValues[] = {
      {.name = "step.error",
       .unit = kErrorLength,
       .help = lasting(
           "distance between the free vertices after a step and where the exact step of implicit "
           "Euler leads from the solver's own state before it, RMS over vertices, mean over one "
           "step in " +
           std::to_string(kEvery) + ", or " + std::to_string(kMostSamples) +
           " steps of a long run; the last substep is judged if the solver has substeps. No value "
           "if fewer than " +
           percent(kEnough) + " of these steps can be believed, or with more than " +
           std::to_string(kMostFree) + " free vertices"),
       .window = Window::run,
       .title = "distance from the exact step",
       .role = Role::step_error,
       .negligible = 1e-6},
      {"step.error.peak", kErrorLength, "the largest of these steps", false, Window::run,
       "largest distance from the exact step"},
      {.name = kShareBySteps,
       .unit = kSignedShare,
       // w.(w + l)/|w + l|^2 with w the cloth's way and l the sum over steps of (T - t) times the
       // velocity that the step at t misses along its own way. A step rounds by |x|/sqrt(3) times
       // 2^-24 if all coordinates are floats, else 2^-53.
       .help = lasting(
           "how much of the way that exact steps would have led the cloth it has gone, in the "
           "time " +
           first_time_text() +
           "; estimated from what each step misses, relative to the pins or else to the centre of "
           "mass. 0: it stands still. No value if the way is at most " +
           percent(kLeastWay) + " of the cloth's size or longer than " + as_typed(kMostFalls) +
           " falls, if rounding may be more than " + percent(kMostRounding) +
           " of it, or if way.share has a value, which knows the exact steps"),
       .window = Window::none,
       .title = "share of the way, from what steps miss"},
      {"step.error.believed", kSignedShare,
       "share of these steps whose distance can be believed, since the sheet is not about to "
       "buckle",
       false, Window::run, "steps whose distance from the exact one can be believed"},
  };
  static constexpr bool kFollowsPath = true;

  explicit StepErrors(const Scene& scene)
      : scene_(scene),
        stages_(stages(scene)),
        every_(std::max(kEvery, (scene.steps + kMostSamples - 1) / kMostSamples)),
        first_(reference::has_exact_path(scene) ? 0 : first_steps(scene)),
        first_every_(std::max(1, first_ / kFirstSamples)),
        lost_(scene.start.x.size(), Vec3::Zero()),
        rounded_(scene.start.x.size(), 0.0) {}

  void declare(const DeclaredStep& step) override {
    declared_ = step;
    if (declared_.none.empty() && free_vertices(scene_).size() > kMostFree)
      declared_.none = "more than " + std::to_string(kMostFree) + " free vertices";
    if (!declared_.none.empty()) return;
    enter(0);
  }
  bool follows(int step) const override {
    return error_ && declared_.substeps > 1 && (samples(step) || samples_first(step));
  }
  void observe_within(const Snapshot& m) override {
    before_ = m.state;
    step_before_ = m.step;
  }
  void observe(const Snapshot& m) override {
    const std::vector<Release>& releases = scene_.releases;
    if (declared_.none.empty() && stage_ < releases.size() && m.step > releases[stage_].step)
      enter(stage_ + 1);
    if (!error_) return;
    const int substeps = declared_.substeps;
    const bool known = m.step > 0 && step_before_ == (substeps > 1 ? m.step : m.step - 1);
    if (known && samples(m.step)) judge(m);
    if (known && samples_first(m.step)) add_missed(m);
    if (m.step == first_) end_ = m.state.x;
    if (substeps == 1 && (samples(m.step + 1) || samples_first(m.step + 1))) observe_within(m);
  }
  std::vector<double> finish() override {
    const double none = Summary::kNone;
    if (count_ == 0) return {none, none, none, none};
    const double share = way_share();
    const double believed = believed_ / static_cast<double>(count_);
    if (believed < kEnough) return {none, none, share, believed};
    return {sum_ / believed_, peak_, share, believed};
  }
  std::vector<double> now(const Snapshot&) const override {
    return {Summary::kNone, Summary::kNone, Summary::kNone, Summary::kNone};
  }
  std::string remark() const override {
    if (!declared_.none.empty()) return "no value: " + declared_.none;
    std::string text = "from one implicit Euler step of " + declared_.of;
    if (believed_ < count_)
      text += "; " + std::to_string(count_ - static_cast<int>(believed_)) + " of " +
              std::to_string(count_) + " steps cannot be believed";
    return text;
  }

 private:
  /// Between releases of pins, the exact step is that of the remaining pins.
  void enter(std::size_t stage) {
    stage_ = stage;
    error_.reset();
    if (!free_vertices(stages_[stage]).empty()) error_.emplace(stages_[stage], declared_.stiffness);
  }
  bool samples(int step) const { return (scene_.steps - step) % every_ == 0; }
  bool samples_first(int step) const {
    return step > 0 && step <= first_ && step % first_every_ == 0;
  }
  double substep() const { return scene_.dt / declared_.substeps; }

  void add_missed(const Snapshot& m) {
    ++first_count_;
    const double h = substep();
    const std::vector<Vec3> missed = along_the_way(before_, m, h);
    if (missed.empty()) return;
    ++first_believed_;
    const double left = first_ * scene_.dt - m.t;
    // assume as much in each substep of these steps
    const double times = left * first_every_ * declared_.substeps / h;
    const double rounding = relative_rounding(m.state.x);
    for (std::size_t i = 0; i < missed.size(); ++i) {
      lost_[i] += times * missed[i];
      rounded_[i] += times * rounding * m.state.x[i].norm();
    }
  }
  /// Part of the exact step's displacement that the step from `before` misses, along that
  /// displacement; a deviation across it does not keep a cloth back. Empty if it cannot be
  /// believed.
  std::vector<Vec3> along_the_way(const State& before, const Snapshot& m, double h) {
    std::vector<Vec3> missed = error_->missed(before, m.t - h, h, m.state.x);
    if (missed.empty()) return missed;
    std::vector<Vec3> way = m.state.x;
    for (std::size_t i = 0; i < way.size(); ++i) way[i] += missed[i] - before.x[i];
    const Vec3 common = scene_.pins.empty()
                            ? weighted_mean(scene_, way)
                            : way_of_pins(scene_, m.t) - way_of_pins(scene_, m.t - h);
    double along = 0, square = 0;
    for (std::size_t i = 0; i < way.size(); ++i) {
      way[i] -= common;
      along += missed[i].dot(way[i]);
      square += way[i].squaredNorm();
    }
    const double share = square > 0 ? along / square : 0;
    for (std::size_t i = 0; i < way.size(); ++i) missed[i] = share * way[i];
    return missed;
  }
  double way_share() const {
    if (end_.empty() || first_believed_ < kEnough * first_count_ || first_believed_ == 0)
      return Summary::kNone;
    const double seconds = first_ * scene_.dt, scale = first_count_ / first_believed_;
    std::vector<Vec3> way = end_, full = end_;
    for (std::size_t i = 0; i < way.size(); ++i) {
      way[i] -= scene_.start.x[i];
      full[i] = way[i] + scale * lost_[i];
    }
    keep_own_way(scene_, seconds, way);
    keep_own_way(scene_, seconds, full);
    double along = 0, square = 0, rounding = 0;
    const std::vector<std::size_t> free = free_vertices(scene_);
    for (const std::size_t i : free) {
      along += way[i].dot(full[i]);
      square += full[i].squaredNorm();
      rounding += std::pow(scale * rounded_[i], 2);
    }
    const double rms = std::sqrt(square / static_cast<double>(free.size()));
    const bool known = rounding <= kMostRounding * kMostRounding * square;
    const bool moves = rms >= kLeastWay * extent(scene_) && rms <= farthest(scene_, seconds);
    if (!known || !moves) return Summary::kNone;
    return along / square;
  }
  void judge(const Snapshot& m) {
    const double h = substep();
    const auto error = error_->of(before_, m.t - h, h, m.state.x);
    ++count_;
    if (!error.believed) return;
    ++believed_;
    sum_ += error.distance;
    peak_ = std::max(peak_, error.distance);
  }

  const Scene& scene_;  ///< the run's scene, which outlives its metrics
  std::vector<Scene> stages_;
  std::size_t stage_ = 0;
  /// Steps; first_ is 0 if way.share already measures the displacement.
  int every_, first_, first_every_;
  DeclaredStep declared_{.none = "no step is declared"};
  std::optional<reference::StepError> error_;  ///< empty: no value
  State before_;
  int step_before_ = -1;
  std::vector<Vec3> lost_, end_;  ///< m; end_: positions after the first steps
  std::vector<double> rounded_;   ///< m, part of lost_ that may be rounding
  double first_count_ = 0, first_believed_ = 0;
  int count_ = 0;
  double believed_ = 0, sum_ = 0, peak_ = 0;  ///< steps, m, m
};

}  // namespace

TAUT_METRIC(step_error, StepErrors,
            "How far each step is from the exact one, without a reference in motion",
            "Newton's method from the solver's own answer");

}  // namespace taut
