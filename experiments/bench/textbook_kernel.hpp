#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "core/model/mesh.hpp"

namespace taut {

/// The published loop as one would type it: x, y, z in an array of structures, the links as they
/// come, the root and the divisions where the listing has them. What every speed is compared with.
template <class Real>
class TextbookKernel {
 public:
  TextbookKernel(const std::vector<Vec3>& start, std::span<const double> w,
                 std::span<const Link> links) {
    for (std::size_t i = 0; i < start.size(); ++i)
      particles_.push_back({static_cast<Real>(start[i].x()), static_cast<Real>(start[i].y()),
                            static_cast<Real>(start[i].z())}),
          inverse_mass_.push_back(static_cast<Real>(w[i]));
    for (const Link& l : links)
      if (w[static_cast<std::size_t>(l.a)] + w[static_cast<std::size_t>(l.b)] > 0)
        links_.push_back({l.a, l.b, static_cast<Real>(l.rest)});
  }

  void sweep() {
    for (const Stick& c : links_) {
      Point &x1 = particles_[static_cast<std::size_t>(c.a)],
            &x2 = particles_[static_cast<std::size_t>(c.b)];
      const Real w1 = inverse_mass_[static_cast<std::size_t>(c.a)],
                 w2 = inverse_mass_[static_cast<std::size_t>(c.b)];
      const Point delta{x2.x - x1.x, x2.y - x1.y, x2.z - x1.z};
      const Real length = std::sqrt(delta.x * delta.x + delta.y * delta.y + delta.z * delta.z);
      const Real diff = (length - c.rest) / (length * (w1 + w2));
      x1.x += w1 * diff * delta.x, x1.y += w1 * diff * delta.y, x1.z += w1 * diff * delta.z;
      x2.x -= w2 * diff * delta.x, x2.y -= w2 * diff * delta.y, x2.z -= w2 * diff * delta.z;
    }
  }

  std::size_t links() const { return links_.size(); }

 private:
  struct Point {
    Real x, y, z;
  };
  struct Stick {
    int a, b;
    Real rest;
  };
  std::vector<Point> particles_;
  std::vector<Real> inverse_mass_;
  std::vector<Stick> links_;
};

}  // namespace taut
