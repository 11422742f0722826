#pragma once

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "core/reference/implicit_step.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

inline Scene elastic(Scene s, double stiffness) {
  s.stiffness = {stiffness, stiffness, stiffness};
  return s;
}

inline Scene hung_sheet(int side) {
  Scene s = under_gravity(bare::sheet(side, side, {.shear = true}));
  s.pins = {0, side - 1};
  return s;
}

/// A sheet pinned by its top edge, which starts 45 degrees aside.
inline Scene swinging_sheet(int side) {
  Scene s = hung_sheet(side);
  s.pins.clear();
  for (int i = 0; i < side; ++i) s.pins.push_back(i);
  for (Vec3& x : s.start.x) x = Vec3(x.x(), x.y() * std::sqrt(0.5), x.y() * std::sqrt(0.5));
  return s;
}

/// The first step of a scene, and how far its end after some iterations is from its exact end.
class FirstStep {
 public:
  explicit FirstStep(const Scene& s)
      : scene_(s), step_(s, s.start, 0, s.stiffness), exact_(step_.minimum(s.start.x).x) {}

  /// RMS [m].
  double distance(std::string_view solver, int iterations) const {
    return step_.distance(end(solver, iterations), exact_);
  }
  /// Worst vertex [m].
  double farthest(std::string_view solver, int iterations) const {
    return max_distance(end(solver, iterations), exact_);
  }
  double residual(std::string_view solver, int iterations) const {  ///< N
    return step_.residual(end(solver, iterations));
  }
  /// Distance of the exact end from where the vertices would go without links [m].
  double way() const { return step_.distance(step_.prediction(), exact_); }

 private:
  std::vector<Vec3> end(std::string_view solver, int iterations) const {
    return Simulation(scene_, with(solver, "iterations=" + std::to_string(iterations)), 1)
        .state()
        .x;
  }
  Scene scene_;
  reference::ImplicitStep step_;
  std::vector<Vec3> exact_;
};

}  // namespace taut
