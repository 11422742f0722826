#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/metrics/metric.hpp"

namespace taut {

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
    sum_ += value, ++count_;
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

}  // namespace taut
