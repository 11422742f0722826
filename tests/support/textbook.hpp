#pragma once

#include <cmath>
#include <vector>

#include "core/model/scene.hpp"

namespace taut {

/// Jakobsen's listing, transcribed literally and in double for particles of any mass: the oracle of
/// everything in core/solver. No layout, no precomputed shares, no idea of speed.
struct Textbook {
  const Scene& scene;
  std::vector<Vec3> x, old_x;
  std::vector<double> w;

  explicit Textbook(const Scene& s) : scene(s), x(s.start.x), w(inverse_masses(s)) {
    for (std::size_t i = 0; i < x.size(); ++i)
      old_x.push_back(w[i] == 0 ? x[i] : Vec3(x[i] - s.dt * s.start.v[i]));
  }

  void step(int iterations, bool square_root) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (w[i] == 0) continue;
      const Vec3 temp = x[i];
      x[i] += std::exp(-scene.damping * scene.dt) * (x[i] - old_x[i]) +
              scene.gravity * scene.dt * scene.dt;
      old_x[i] = temp;
    }
    for (int k = 0; k < iterations; ++k)
      for (const Link& c : scene.links) {
        Vec3 &x1 = x[static_cast<std::size_t>(c.a)], &x2 = x[static_cast<std::size_t>(c.b)];
        const double w1 = w[static_cast<std::size_t>(c.a)], w2 = w[static_cast<std::size_t>(c.b)];
        if (w1 + w2 == 0) continue;
        const Vec3 delta = x2 - x1;
        double diff = 0;
        if (square_root) {
          const double deltalength = std::sqrt(delta.dot(delta));
          diff = (deltalength - c.rest) / (deltalength * (w1 + w2));
        } else {
          diff = (delta.dot(delta) - c.rest * c.rest) /
                 ((delta.dot(delta) + c.rest * c.rest) * (w1 + w2));
        }
        x1 += w1 * delta * diff;
        x2 -= w2 * delta * diff;
      }
  }
};

}  // namespace taut
