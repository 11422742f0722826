#pragma once

#include <map>
#include <string>
#include <vector>

namespace taut {

// Comparing a case with an earlier result of it: from a baseline (experiments/baseline), another
// results folder (experiments/report) or another build (experiments/history).

/// How far a value may move: |now - before| <= absolute + relative * |before|.
struct Tolerance {
  double absolute = 0;  ///< in the metric's unit
  double relative = 0;
  bool ignored = false;  ///< never compared
  std::string reason;    ///< why this much and no more; never empty

  bool holds(double value, double before) const;
};

/// Tolerances by metric value ("stretch.max"), by metric ("stretch") or for all others ("default").
class Tolerances {
 public:
  Tolerances() = default;
  explicit Tolerances(std::map<std::string, Tolerance> by_name) : by_name_(std::move(by_name)) {}
  /// Accepts no difference.
  static Tolerances exact();
  /// The most specific tolerance for the value; the built-in default (relative 1e-6, absolute
  /// 1e-12) if none is given.
  const Tolerance& of(const std::string& value) const;

 private:
  std::map<std::string, Tolerance> by_name_;
};

/// A value before and now.
struct ComparedValue {
  enum class Kind {
    same,    ///< within the tolerance
    moved,   ///< beyond it, or a number has come or gone
    lost,    ///< the value no longer exists
    gained,  ///< the value did not exist before
  };
  std::string value;           ///< "stretch.rms"
  double before = 0, now = 0;  ///< NaN: no meaning, or no such value
  Kind kind = Kind::same;

  bool both_finite() const;
};

using MetricValues = std::map<std::string, double>;
/// Compares all values of both sides that are not ignored, by name; gained ones come last.
std::vector<ComparedValue> compare_values(const MetricValues& before, const MetricValues& now,
                                          const Tolerances&);

/// (now - before) / |before|; infinite where there was 0 or no number.
double relative_change(double before, double now);
/// (now - before) over the larger of the two in size: from -2 to 2. Precondition: both are finite.
double mutual_change(double before, double now);

}  // namespace taut
