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

/// One step boundary as a metric sees it: the scene's time and the state, never the solver that
/// made it.
struct Snapshot {
  int step = 0;  ///< 0: the start
  double t = 0;  ///< s
  const State& state;
};

/// In which unit a value is stored, and how people are shown it: `shown = scale * stored`.
struct Unit {
  std::string_view si;     ///< "1" if dimensionless
  std::string_view shown;  ///< "%", "mm", ...
  double scale = 1;
  bool logarithmic = true;      ///< which axis suits it
  bool less_is_better = false;  ///< of an error: the distance from what must hold
};
inline constexpr Unit kNumber{"1", ""}, kCount{"1", "", 1, false}, kShare{"1", "%", 100},
    kSignedShare{"1", "%", 100, false}, kLength{"m", "mm", 1e3},
    kSignedLength{"m", "mm", 1e3, false}, kTime{"s", "s", 1, false}, kSpeed{"m/s", "m/s"},
    kAcceleration{"m/s^2", "m/s\u00B2"}, kForce{"N", "N", 1, false};
/// The same of errors, which are never below 0.
inline constexpr Unit kErrorCount{"1", "", 1, false, true}, kErrorShare{"1", "%", 100, true, true},
    kErrorLength{"m", "mm", 1e3, true, true}, kErrorSpeed{"m/s", "m/s", 1, true, true},
    kErrorAcceleration{"m/s^2", "m/s\u00B2", 1, true, true};

/// The part of a run that a value describes.
enum class Window { last_second, run, end, none };
/// "last second", "whole run", "end of the run", "".
constexpr std::string_view to_string(Window w) {
  return w == Window::last_second ? "last second"
         : w == Window::run       ? "whole run"
         : w == Window::end       ? "end of the run"
                                  : "";
}

/// What a report makes of a value beside listing it: over what its charts draw it, and what
/// sentences say of it. Reports show the roles in this order.
enum class Role {
  none,    ///< drawn on demand alone
  error,   ///< of something that a solver must keep; over sweeps; its mean over scenes is compared
  motion,  ///< what a motion loses or lags behind; over sweeps; strain alone does not show it
  vertex_depth,     ///< of a vertex below a surface; over sweeps and time steps; the deepest counts
  face_depth,       ///< the same of a face
  passages,         ///< of vertices through colliders; drawn as depths; the sum over scenes counts
  reference_error,  ///< distance from the scene's reference; over sweeps
  step_error,       ///< distance from the exact step; over sweeps
  contact_error,    ///< distance from a law of contact; over sweeps and time steps
};

/// Cloth that goes less than this share of its way is not compared by strain: links keep their
/// lengths where nothing moves.
inline constexpr double kLeastMotion = 0.5;
/// Whose way where there is no dynamic reference: that of exact steps, else by what steps miss.
inline constexpr std::string_view kShareOfWay = "way.share", kShareBySteps = "step.share";

/// RMS strain at the moment of a run at which it is largest: what the last second hides.
inline constexpr std::string_view kRmsStretchPeak = "stretch.rms.peak";
/// Distance from the dynamic reference over the way: 1 of a cloth that stands still.
inline constexpr std::string_view kMotionError = "motion.error";
/// RMS strain that the rounding of a file of positions makes: the number of the resolved setting of
/// this name, which cases have that play such a file. No metric returns it.
inline constexpr std::string_view kStrainFloor = "strain.floor";

/// A number that a metric yields.
struct ValueSpec {
  /// Below it a value says nothing about the solver: another value of the case, and what it is.
  struct Floor {
    std::string_view value, text;
  };
  std::string_view name;  ///< "stretch.rms"; unique over all metrics
  Unit unit;
  std::string_view help;   ///< its definition, one sentence
  bool in_series = false;  ///< also meaningful at each moment: recorded over time as well
  Window window = Window::last_second;
  std::string_view title = "";  ///< a few words; "": made from the name
  Role role = Role::none;
  double negligible = 0;         ///< of an error, SI, > 0: what is less counts as this in means
  bool shown_over_time = false;  ///< beside the scene's film; needs in_series
  bool kept = false;             ///< an answer that `taut require` keeps unless asked otherwise
  Floor floor = {};
  bool falls_with_sweeps = false;  ///< as 1 / sweeps, where theory has the links' stretch do so
};

/// Watches one run. `observe` sees every step boundary in order, the start included, and must be
/// cheap or choose its own moments; `finish` is called once and returns the values in the entry's
/// order. A value that has no meaning for this run is NaN (stored as null, drawn as absent).
class Metric {
 public:
  virtual ~Metric() = default;
  /// Whether the scene has what is measured; a metric that asks for something hides it.
  static bool measures(const Scene&) { return true; }
  /// Whether it needs the path between step boundaries, too: see observe_within.
  static constexpr bool kFollowsPath = false;
  /// Before a run: which step its solver declares, and nothing else of it.
  virtual void declare(const DeclaredStep&) {}
  virtual void observe(const Snapshot&) = 0;
  /// The ends of the substeps between two boundaries, in order: the moment's step is the one that
  /// they lead to. Only called if `kFollowsPath`.
  virtual void observe_within(const Snapshot&) {}
  virtual bool follows(int) const { return true; }  ///< whether within the step that leads to it
  virtual std::vector<double> finish() = 0;
  /// The values of this very moment, for series; same order, NaN where `in_series` is false.
  virtual std::vector<double> now(const Snapshot&) const = 0;
  /// After a run: what its values are of, or why there are none; "": the entry says it all.
  virtual std::string remark() const { return ""; }
};

/// How a metric introduces itself: one per file, found by its TAUT_METRIC line.
struct MetricEntry {
  std::string_view name;     ///< "stretch"
  std::string_view summary;  ///< one sentence
  std::string_view source;   ///< definition: paper, closed form
  std::span<const ValueSpec> values;
  /// nullptr if the scene lacks what is measured (penetration without colliders).
  std::unique_ptr<Metric> (*make)(const Scene&);
  bool follows_path = false;  ///< Metric::kFollowsPath
};

/// All metrics of this program, sorted by name (generated; see cmake/registry.cmake).
std::span<const MetricEntry* const> metrics();

/// What yields the value of this name: its metric and itself; nulls: nothing does.
inline std::pair<const MetricEntry*, const ValueSpec*> find_value(std::string_view name) {
  for (const MetricEntry* metric : metrics())
    for (const ValueSpec& value : metric->values)
      if (value.name == name) return {metric, &value};
  return {};
}

/// The names of all values of all metrics.
inline std::vector<std::string> value_names() {
  std::vector<std::string> names;
  for (const MetricEntry* metric : metrics())
    for (const ValueSpec& value : metric->values) names.emplace_back(value.name);
  return names;
}

/// The values that have a role, in the order of roles.
inline std::vector<const ValueSpec*> values_with_role() {
  std::vector<const ValueSpec*> values;
  for (const MetricEntry* metric : metrics())
    for (const ValueSpec& value : metric->values)
      if (value.role != Role::none) values.push_back(&value);
  std::ranges::stable_sort(values, {}, &ValueSpec::role);
  return values;
}

/// For MetricEntry::make.
template <class M>
std::unique_ptr<Metric> make_metric(const Scene& scene) {
  return M::measures(scene) ? std::make_unique<M>(scene) : nullptr;
}

/// The part of a run by which it is judged "at the end": the last second of simulated time, or all
/// of it after the start if it is shorter. Its last moment is the end of the run.
class LastSecond {
 public:
  explicit LastSecond(const Scene& scene)
      : last_(scene.steps),
        length_(
            std::clamp(static_cast<int>(std::lround(1 / scene.dt)), 1, std::max(1, scene.steps))) {}

  bool contains(int step) const { return step > last_ - length_; }

  /// At most kSamples moments, evenly spread and the last one among them: for what is too dear to
  /// be computed at every step.
  bool samples(int step) const {
    return contains(step) && (last_ - step) % std::max(1, length_ / kSamples) == 0 &&
           (last_ - step) / std::max(1, length_ / kSamples) < kSamples;
  }
  static constexpr int kSamples = 10;

 private:
  int last_;
  int length_;
};

/// What is left of a quantity that is known at every step: its mean and its maximum over the last
/// second, and its maximum over the run. The start is not counted: it is the scene's doing. NaN if
/// the run did not get that far.
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

/// The vertices that a solver moves, those that a pin lets go among them, ascending.
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

/// Mean of a quantity of the vertices, weighted by their masses.
inline Vec3 mean(const std::vector<double>& mass, const std::vector<Vec3>& vectors) {
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    sum += mass[i] * vectors[i];
    total += mass[i];
  }
  return sum / total;
}

/// Whether there is a collider with another side: any but a plane.
inline bool has_solid(const Scene& scene) {
  return std::ranges::any_of(
      scene.colliders, [](const Collider& c) { return !std::holds_alternative<Plane>(c.shape); });
}

}  // namespace taut

/// A metric within namespace taut, from its class, which has a constructor from a Scene and `static
/// constexpr ValueSpec kValues[]`; then the entry's summary and source.
#define TAUT_METRIC(id, Class, summary, source)                                     \
  extern const MetricEntry metric_##id;                                             \
  const MetricEntry metric_##id {                                                   \
#id, summary, source, Class::kValues, make_metric < Class>, Class::kFollowsPath \
  }
