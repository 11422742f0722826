#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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
    kAcceleration{"m/s^2", "m/s\u00B2"};
/// The same of errors, which are never below 0.
inline constexpr Unit kErrorCount{"1", "", 1, false, true}, kErrorShare{"1", "%", 100, true, true},
    kErrorLength{"m", "mm", 1e3, true, true},
    kErrorAcceleration{"m/s^2", "m/s\u00B2", 1, true, true};

/// Of which part of a run a value speaks.
enum class Window { last_second, run, end, none };
/// "last second", "whole run", "end of the run", "".
constexpr std::string_view to_string(Window w) {
  return w == Window::last_second ? "last second"
         : w == Window::run       ? "whole run"
         : w == Window::end       ? "end of the run"
                                  : "";
}

/// A number that a metric yields.
struct ValueSpec {
  std::string_view name;  ///< "stretch.rms"; unique over all metrics
  Unit unit;
  std::string_view help;   ///< its definition, one sentence
  bool in_series = false;  ///< also meaningful at each moment: recorded over time as well
  Window window = Window::last_second;
  std::string_view title = "";  ///< a few words; "": made from the name
};

/// Watches one run. `observe` sees every step boundary in order, the start included, and must be
/// cheap or choose its own moments; `finish` is called once and gives the values in the entry's
/// order. A value that has no meaning for this run is NaN (stored as null, drawn as absent).
class Metric {
 public:
  virtual ~Metric() = default;
  /// Whether the scene has what is measured; a metric that asks for something hides it.
  static bool measures(const Scene&) { return true; }
  /// Whether it needs the path between step boundaries, too: see observe_within.
  static constexpr bool kFollowsPath = false;
  virtual void observe(const Snapshot&) = 0;
  /// The ends of the substeps between two boundaries, in order: the moment's step is the one that
  /// they lead to. Only called if `kFollowsPath`.
  virtual void observe_within(const Snapshot&) {}
  virtual std::vector<double> finish() = 0;
  /// The values of this very moment, for series; same order, NaN where `in_series` is false.
  virtual std::vector<double> now(const Snapshot&) const = 0;
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

/// For MetricEntry::make.
template <class M>
std::unique_ptr<Metric> make_metric(const Scene& scene) {
  return M::measures(scene) ? std::make_unique<M>(scene) : nullptr;
}

}  // namespace taut

/// A metric within namespace taut, from its class, which has a constructor from a Scene and `static
/// constexpr ValueSpec kValues[]`; then the entry's summary and source.
#define TAUT_METRIC(id, Class, summary, source)                                     \
  extern const MetricEntry metric_##id;                                             \
  const MetricEntry metric_##id {                                                   \
#id, summary, source, Class::kValues, make_metric < Class>, Class::kFollowsPath \
  }
