#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/index.hpp"
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

/// The vertices that a solver moves, ascending.
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
  for (std::size_t i = 0; i < mass.size(); ++i) sum += mass[i] * vectors[i], total += mass[i];
  return sum / total;
}

/// Whether there is a ball or a box: a plane has no other side.
inline bool has_solid(const Scene& scene) {
  return std::ranges::any_of(
      scene.colliders, [](const Collider& c) { return !std::holds_alternative<Plane>(c.shape); });
}

}  // namespace taut
