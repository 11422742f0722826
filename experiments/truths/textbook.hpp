#pragma once

#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// The published TimeStep() in double, line by line, with nothing made fast: the oracle that the
/// solvers are compared with, which also keeps what a solver need not keep, the corrections.
/// Gravity, links in the scene's order and pins at rest; nothing else.
class TextbookWithTensions {
 public:
  TextbookWithTensions(const Scene& scene, int iterations)
      : scene_(scene), iterations_(iterations), w_(inverse_masses(scene)) {}

  void load(const State& state) {
    x_ = old_ = state.x;
    for (std::size_t i = 0; i < x_.size(); ++i) old_[i] -= scene_.dt * state.v[i];
  }

  void step() {
    for (std::size_t i = 0; i < x_.size(); ++i) {  // Verlet
      const Vec3 now = x_[i];
      if (w_[i] > 0) x_[i] += now - old_[i] + scene_.gravity * scene_.dt * scene_.dt;
      old_[i] = now;
    }
    lambda_.assign(scene_.links.size(), 0);
    for (int k = 0; k < iterations_; ++k)  // SatisfyConstraints
      for (std::size_t j = 0; j < scene_.links.size(); ++j) {
        const Link& link = scene_.links[j];
        const auto a = static_cast<std::size_t>(link.a), b = static_cast<std::size_t>(link.b);
        if (w_[a] + w_[b] == 0) continue;
        const Vec3 delta = x_[b] - x_[a];
        const double length = delta.norm();
        const double diff = (length - link.rest) / (length * (w_[a] + w_[b]));
        x_[a] += w_[a] * diff * delta;
        x_[b] -= w_[b] * diff * delta;
        lambda_[j] += diff * length;
      }
  }

  const std::vector<Vec3>& x() const { return x_; }
  /// [links] kg m, of the last step: force times dt^2.
  const std::vector<double>& lambda() const { return lambda_; }

 private:
  Scene scene_;
  int iterations_;
  std::vector<double> w_, lambda_;
  std::vector<Vec3> x_, old_;
};

}  // namespace taut
