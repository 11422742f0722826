#include <algorithm>
#include <cmath>
#include <string>

#include "core/model/text.hpp"
#include "core/reference/exact_path.hpp"
#include "experiments/metrics/metric.hpp"
#include "experiments/metrics/own_way.hpp"

namespace taut {

namespace {

constexpr int kSamples = 8;  ///< number of moments that are compared
/// Most steps of the exact path: it joins steps of longer runs.
constexpr int kMostSteps = 64;
/// Least displacement of the cloth, as a share of the scene's extent.
constexpr double kLeast = 0.01;
/// Largest stiffness of links [N/m]. Links of 1e5 N/m move as far as those of 1e8 to 0.5 % on
/// `drape` and to 0.1 % on `swing`; those of 1e3 N/m move 1.43 times as far on `drape`.
constexpr double kMostStiffness = 1e5;

/// How far a cloth moves in its first T. It does not depend on what the solver is, only on where
/// its steps lead.
class Way final : public Metric {
 public:
  static inline const ValueSpec kValues[] = {
      {.name = kShareOfWay,
       .unit = kSignedShare,
       .help = lasting(
           "share of the way that exact steps of implicit Euler lead the cloth in the time " +
           first_time_text() + ": sum of w.e over sum of |e|^2 at " + std::to_string(kSamples) +
           " moments. w is the cloth's way from the start relative to its pins; e is that of "
           "exact steps of the scene's links, with at most " +
           as_typed(kMostStiffness) +
           " N/m. 0 if the cloth stands still. No value with contact, bending, wind or pins that "
           "let go, with more than " +
           std::to_string(kMostFree) + " free vertices, or if e is less than " + percent(kLeast) +
           " of the cloth's size, RMS over vertices"),
       .window = Window::none,
       .title = "share of the way of exact steps"},
  };

  static bool measures(const Scene& scene) {
    const std::size_t free = free_vertices(scene).size();
    return reference::has_exact_path(scene) && !scene.links.empty() && free > 0 &&
           free <= kMostFree;
  }
  explicit Way(const Scene& scene)
      : scene_(scene),
        joined_(std::max(1, first_steps(scene) / kMostSteps)),
        every_(std::max(1, first_steps(scene) / (joined_ * kSamples)) * joined_) {}

  void observe(const Snapshot& m) override {
    if (m.step > 0 && m.step <= first_steps(scene_) && m.step % every_ == 0)
      places_.push_back(m.state.x);
  }
  std::vector<double> finish() override { return {share()}; }
  std::vector<double> now(const Snapshot&) const override { return {Summary::kNone}; }

 private:
  double share() const {
    Scene exact = scene_;
    exact.dt *= joined_;
    for (double& k : exact.stiffness) k = std::min(k, kMostStiffness);
    std::vector<int> steps;
    for (std::size_t k = 1; k <= places_.size(); ++k)
      steps.push_back(static_cast<int>(k) * every_ / joined_);
    const std::vector<std::vector<Vec3>> path = reference::exact_path(exact, steps);
    const std::vector<std::size_t> free = free_vertices(scene_);
    double along = 0, square = 0, farthest2 = 0;
    for (std::size_t k = 0; k < path.size(); ++k) {
      const std::vector<Vec3> way = own_way(places_[k], steps[k] * exact.dt);
      const std::vector<Vec3> full = own_way(path[k], steps[k] * exact.dt);
      double here = 0;
      for (const std::size_t i : free) {
        along += way[i].dot(full[i]);
        here += full[i].squaredNorm();
      }
      square += here;
      farthest2 = std::max(farthest2, here / static_cast<double>(free.size()));
    }
    const bool moves = std::sqrt(farthest2) >= kLeast * extent(scene_);
    return moves ? along / square : Summary::kNone;
  }
  /// Displacements from the start to positions at time t [m], without the part that keeps the
  /// cloth's shape.
  std::vector<Vec3> own_way(std::vector<Vec3> places, double t) const {
    for (std::size_t i = 0; i < places.size(); ++i) places[i] -= scene_.start.x[i];
    keep_own_way(scene_, t, places);
    return places;
  }

  const Scene& scene_;                     ///< the run's scene, which outlives its metrics
  int joined_, every_;                     ///< steps in one exact step, and between two moments
  std::vector<std::vector<Vec3>> places_;  ///< m, at these moments
};

}  // namespace

TAUT_METRIC(way, Way,
            "How much of its way a cloth goes at first, which shows solvers that freeze it",
            "Newton's method on every step from the scene's start");

}  // namespace taut
