#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/model/declared_step.hpp"
#include "core/model/index.hpp"
#include "core/model/scene.hpp"

namespace taut {

/// A step boundary as seen by a metric: the scene's time and the state, but never the solver.
struct Snapshot {
  int step = 0;  ///< 0: the start
  double t = 0;  ///< s
  const State& state;
};

/// What a value is, the unit in which it is stored, and how it is shown: `shown = scale * stored`.
struct Unit {
  /// Decides what 100 % of a value is and how far it may move by default. Never read from the unit
  /// that people see or from the axis of a chart.
  enum class Kind {
    other,   ///< a number, speed, force, ...: 100 % is the value itself
    count,   ///< of events or things, so that each one matters
    share,   ///< 1 is 100 %; also strains
    length,  ///< of the size of the cloth
    time,    ///< of the duration of the run
  };
  Kind kind;
  std::string_view si;     ///< "1" if dimensionless
  std::string_view shown;  ///< "%", "mm", ...
  double scale = 1;
  bool logarithmic = true;      ///< whether a logarithmic axis suits it
  bool less_is_better = false;  ///< for an error: a distance from what must hold
};
inline constexpr Unit kNumber{Unit::Kind::other, "1", ""},
    kCount{Unit::Kind::count, "1", "", 1, false}, kShare{Unit::Kind::share, "1", "%", 100},
    kSignedShare{Unit::Kind::share, "1", "%", 100, false},
    kLength{Unit::Kind::length, "m", "mm", 1e3},
    kSignedLength{Unit::Kind::length, "m", "mm", 1e3, false},
    kTime{Unit::Kind::time, "s", "s", 1, false}, kSpeed{Unit::Kind::other, "m/s", "m/s"},
    kAcceleration{Unit::Kind::other, "m/s^2", "m/s\u00B2"},
    kForce{Unit::Kind::other, "N", "N", 1, false};
/// Units of errors, which are never below 0.
inline constexpr Unit kErrorCount{Unit::Kind::count, "1", "", 1, false, true},
    kErrorShare{Unit::Kind::share, "1", "%", 100, true, true},
    kErrorLength{Unit::Kind::length, "m", "mm", 1e3, true, true},
    kErrorSpeed{Unit::Kind::other, "m/s", "m/s", 1, true, true},
    kErrorAcceleration{Unit::Kind::other, "m/s^2", "m/s\u00B2", 1, true, true};

/// The part of a run that a value describes.
enum class Window { last_second, run, end, none };
/// "last second", "whole run", "end of the run", "".
constexpr std::string_view to_string(Window w) {
  return w == Window::last_second ? "last second"
         : w == Window::run       ? "whole run"
         : w == Window::end       ? "end of the run"
                                  : "";
}

/// How a report uses a value besides listing it: what its charts draw it over, and what sentences
/// say of it. Reports show the roles in this order.
enum class Role {
  none,  ///< only drawn on demand
  /// Error of something that a solver must keep; over sweeps; its mean over scenes is compared.
  error,
  /// What a motion loses or lags behind, which strain alone does not show; over sweeps.
  motion,
  /// Depth of a vertex below a surface; over sweeps and time steps; the deepest counts.
  vertex_depth,
  face_depth,  ///< depth of a face, otherwise like vertex_depth
  /// Passages of vertices through colliders; drawn like depths; the sum over scenes counts.
  passages,
  reference_error,  ///< distance from the scene's reference; over sweeps
  motion_error,     ///< distance from the scene's motion; over sweeps
  step_error,       ///< distance from the exact step; over sweeps
  contact_error,    ///< distance from a law of contact; over sweeps and time steps
};

/// RMS strain of structural and shear links in the last second.
inline constexpr std::string_view kStretch = "stretch.rms";
/// The same as a law predicts it.
inline constexpr std::string_view kPredicted = "stretch.predicted";
/// RMS strain at the moment at which it is largest in a run; the last second hides it.
inline constexpr std::string_view kRmsStretchPeak = "stretch.rms.peak";
/// Distance from the dynamic reference over the displacement: 1 for a cloth that stands still. Its
/// floor, and the reference's own strain.
inline constexpr std::string_view kMotionError = "motion.error", kMotionFloor = "motion.floor",
                                  kMotionStrain = "motion.strain";
/// Distance of the observables from those of an ensemble of references, where motion is chaotic;
/// its floor, and what a rigid plate at rest on the body scores.
inline constexpr std::string_view kEnsembleError = "ensemble.error",
                                  kEnsembleFloor = "ensemble.floor",
                                  kEnsemblePlate = "ensemble.plate";
/// RMS strain caused by the rounding of a file of positions. It is the number of the resolved
/// setting of this name, which cases that play such a file have. No metric returns it.
inline constexpr std::string_view kStrainFloor = "strain.floor";

/// A number that a metric returns.
struct ValueSpec {
  /// Limit below which a value says nothing about the solver: another value or a resolved setting
  /// of the case, and its meaning.
  struct Floor {
    std::string_view value, text;
  };
  std::string_view name;  ///< "stretch.rms"; unique over all metrics
  Unit unit;
  std::string_view help;   ///< definition in one sentence
  bool in_series = false;  ///< also meaningful at each moment, and then recorded over time
  Window window = Window::last_second;
  std::string_view title = "";  ///< a few words; "": made from the name
  Role role = Role::none;
  double negligible = 0;         ///< of an error, SI, > 0: smaller values count as this in means
  bool shown_over_time = false;  ///< next to the scene's film; needs in_series
  bool kept = false;             ///< an answer that `taut require` keeps unless told otherwise
  Floor floor = {};
  /// As 1 / sweeps, where theory predicts this of the links' stretch.
  bool falls_with_sweeps = false;
};

/// Watches one run. `observe` gets every step boundary in order, including the start, and must be
/// cheap or choose its own moments. `finish` is called once and returns the values in the entry's
/// order. A value without meaning for this run is NaN (stored as null, drawn as absent).
class Metric {
 public:
  virtual ~Metric() = default;
  /// Whether the scene has what the metric measures; a metric with requirements hides this
  /// function.
  static bool measures(const Scene&) { return true; }
  /// Whether the metric also needs the path between step boundaries: see observe_within.
  static constexpr bool kFollowsPath = false;
  /// Called before a run with the step that its solver declares, and nothing else about it.
  virtual void declare(const DeclaredStep&) {}
  virtual void observe(const Snapshot&) = 0;
  /// Gets the ends of the substeps between two boundaries, in order; the snapshot's step is the one
  /// to which they lead. Only called if `kFollowsPath`.
  virtual void observe_within(const Snapshot&) {}
  /// Whether observe_within() is needed within the step that leads to this one.
  virtual bool follows(int) const { return true; }
  /// Called after a run of a solver that has a criterion of convergence, with the number of steps
  /// in which it says that the criterion did not hold.
  virtual void unconverged(int /*steps*/) {}
  virtual std::vector<double> finish() = 0;
  /// The values at this moment, for series, in the same order; NaN where `in_series` is false.
  virtual std::vector<double> now(const Snapshot&) const = 0;
  /// After a run: what its values refer to, or why there is no value; "": the entry says it all.
  virtual std::string remark() const { return ""; }
};

/// Description of a metric: one per file, found by its TAUT_METRIC line.
struct MetricEntry {
  std::string_view name;     ///< "stretch"
  std::string_view summary;  ///< one sentence
  std::string_view source;   ///< definition: paper or closed form
  std::span<const ValueSpec> values;
  /// Returns nullptr if the scene lacks what is measured (penetration without colliders).
  std::unique_ptr<Metric> (*make)(const Scene&);
  bool follows_path = false;  ///< Metric::kFollowsPath
};

/// All metrics of this program, sorted by name (generated; see cmake/registry.cmake).
std::span<const MetricEntry* const> metrics();

/// The value of this name and its metric; nulls if there is no such value.
inline std::pair<const MetricEntry*, const ValueSpec*> find_value(std::string_view name) {
  for (const MetricEntry* metric : metrics())
    for (const ValueSpec& value : metric->values)
      if (value.name == name) return {metric, &value};
  return {};
}

/// Names of all values of all metrics.
inline std::vector<std::string> value_names() {
  std::vector<std::string> names;
  for (const MetricEntry* metric : metrics())
    for (const ValueSpec& value : metric->values) names.emplace_back(value.name);
  return names;
}

/// Values that have a role, in the order of roles.
inline std::vector<const ValueSpec*> values_with_role() {
  std::vector<const ValueSpec*> values;
  for (const MetricEntry* metric : metrics())
    for (const ValueSpec& value : metric->values)
      if (value.role != Role::none) values.push_back(&value);
  std::ranges::stable_sort(values, {}, &ValueSpec::role);
  return values;
}

/// Function for MetricEntry::make.
template <class M>
std::unique_ptr<Metric> make_metric(const Scene& scene) {
  return M::measures(scene) ? std::make_unique<M>(scene) : nullptr;
}

/// The part of a run that counts as its end: the last second of simulated time, or the whole run
/// after the start if it is shorter. Its last moment is the end of the run.
class LastSecond {
 public:
  explicit LastSecond(const Scene& scene)
      : last_(scene.steps),
        length_(
            std::clamp(static_cast<int>(std::lround(1 / scene.dt)), 1, std::max(1, scene.steps))) {}

  bool contains(int step) const { return step > last_ - length_; }

  /// Whether the step is one of at most kSamples moments, evenly spread and including the last: for
  /// values that are too expensive to compute at every step.
  bool samples(int step) const {
    return contains(step) && (last_ - step) % std::max(1, length_ / kSamples) == 0 &&
           (last_ - step) / std::max(1, length_ / kSamples) < kSamples;
  }
  static constexpr int kSamples = 10;
  static std::string samples_text() { return std::to_string(kSamples) + " moments"; }

 private:
  int last_;
  int length_;
};

/// Summary of a quantity that is known at every step: its mean and maximum over the last second,
/// and its maximum over the run. The start does not count, since it is the scene's. NaN if the run
/// did not get that far.
class Summary {
 public:
  void add(int step, bool in_last_second, double value) {
    if (step == 0) return;
    peak_ = larger(peak_, value);
    if (!in_last_second) return;
    max_ = larger(max_, value);
    sum_ += value;
    ++count_;
  }
  double mean() const { return count_ > 0 ? sum_ / count_ : kNone; }
  double max() const { return max_; }
  double peak() const { return peak_; }

  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

 private:
  static double larger(double a, double b) { return a >= b ? a : b; }  // b if a is NaN
  double sum_ = 0;
  int count_ = 0;
  double max_ = kNone, peak_ = kNone;
};

/// The vertices that a solver moves, in ascending order, including those that a pin releases.
inline std::vector<std::size_t> free_vertices(const Scene& scene) {
  std::vector<std::size_t> free;
  for (int i = 0; i < scene.mesh.size(); ++i)
    if (!is_pinned(scene, i)) free.push_back(to_index(i));
  return free;
}

/// Mean of |v|^2 over the given vertices [m^2/s^2].
inline double mean_square_speed(const State& state, const std::vector<std::size_t>& vertices) {
  double sum = 0;
  for (const std::size_t i : vertices) sum += state.v[i].squaredNorm();
  return sum / static_cast<double>(vertices.size());
}

/// Mean of a quantity over the vertices, weighted by their masses.
inline Vec3 mean(const std::vector<double>& mass, const std::vector<Vec3>& vectors) {
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    sum += mass[i] * vectors[i];
    total += mass[i];
  }
  return sum / total;
}

/// Whether any collider has another side, that is, is not a plane.
inline bool has_solid(const Scene& scene) {
  return std::ranges::any_of(
      scene.colliders, [](const Collider& c) { return !std::holds_alternative<Plane>(c.shape); });
}

}  // namespace taut

/// Defines a metric within namespace taut from its class, which has a constructor from a Scene and
/// `static constexpr ValueSpec kValues[]`; then follow the entry's summary and source.
#define TAUT_METRIC(id, Class, summary, source)                                     \
  extern const MetricEntry metric_##id;                                             \
  const MetricEntry metric_##id {                                                   \
#id, summary, source, Class::kValues, make_metric < Class>, Class::kFollowsPath \
  }
