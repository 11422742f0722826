#include "core/reference/step_error.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "core/model/text.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/metrics/own_way.hpp"

namespace taut {

namespace {

/// Every kEvery-th step is judged, at most kMostSamples of them including the last, and only for at
/// most kMostFree vertices: each judgement takes as long as some forty steps of Jakobsen's solver.
constexpr int kEvery = 16, kMostSamples = 8;
/// Least share of the judged steps that must be believed.
constexpr double kEnough = 0.5;
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
      {"step.error.believed", kSignedShare,
       "share of these steps whose distance can be believed, since the sheet is not about to "
       "buckle",
       false, Window::run, "steps whose distance from the exact one can be believed"},
  };
  static constexpr bool kFollowsPath = true;

  explicit StepErrors(const Scene& scene)
      : scene_(scene),
        stages_(stages(scene)),
        every_(std::max(kEvery, (scene.steps + kMostSamples - 1) / kMostSamples)) {}

  void declare(const DeclaredStep& step) override {
    declared_ = step;
    if (declared_.none.empty() && free_vertices(scene_).size() > kMostFree)
      declared_.none = "more than " + std::to_string(kMostFree) + " free vertices";
    if (!declared_.none.empty()) return;
    enter(0);
  }
  bool follows(int step) const override {
    return error_ && declared_.substeps > 1 && samples(step);
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
    if (substeps == 1 && samples(m.step + 1)) observe_within(m);
  }
  std::vector<double> finish() override {
    const double none = Summary::kNone;
    if (count_ == 0) return {none, none, none};
    const double believed = believed_ / static_cast<double>(count_);
    if (believed < kEnough) return {none, none, believed};
    return {sum_ / believed_, peak_, believed};
  }
  std::vector<double> now(const Snapshot&) const override {
    return {Summary::kNone, Summary::kNone, Summary::kNone};
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
  double substep() const { return scene_.dt / declared_.substeps; }

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
  int every_;  ///< steps
  DeclaredStep declared_{.none = "no step is declared"};
  std::optional<reference::StepError> error_;  ///< empty: no value
  State before_;
  int step_before_ = -1;
  int count_ = 0;
  double believed_ = 0, sum_ = 0, peak_ = 0;  ///< steps, m, m
};

}  // namespace

TAUT_METRIC(step_error, StepErrors,
            "How far each step is from the exact one, without a reference in motion",
            "Newton's method from the solver's own answer");

}  // namespace taut
