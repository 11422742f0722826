#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/model/collider.hpp"
#include "core/reference/closed_forms.hpp"
#include "experiments/truths/truth.hpp"

namespace taut {

/// A light rope over half of a rough cylinder about z, with a load of 1 kg at one end and a heavier
/// one at the other.
struct Capstan {
  static constexpr double kFriction = 0.3, kRadius = 0.5;  ///< kRadius in m
  int links = 24;                                          ///< around the cylinder
  double out = 1;  ///< radius of its vertices over that of the cylinder

  double angle() const { return std::numbers::pi / links; }
  /// Ratio of the tensions at both ends on the verge of slipping, if the vertices touch the
  /// cylinder or if the middles of the links do.
  double ratio() const { return reference::capstan_ratio(kFriction, std::numbers::pi, angle()); }
  double ratio_of_links() const {
    return reference::capstan_ratio_of_links(kFriction, std::numbers::pi, angle());
  }

  /// heavy: mass of the heavier load [kg].
  Scene scene(const Shape& cylinder, double heavy) const {
    constexpr int kBelow = 4;  // links that hang on either side
    const double radius = kRadius * out, l = 2 * radius * std::sin(angle() / 2);
    std::vector<Vec3> x;
    std::vector<Link> rods;
    std::vector<double> mass;
    for (int i = -kBelow; i <= links + kBelow; ++i) {
      const double phi = std::clamp(i, 0, links) * angle();
      const double down = std::max({0, -i, i - links}) * l;
      x.push_back(radius * Vec3(-std::cos(phi), std::sin(phi), 0) - Vec3(0, down, 0));
      mass.push_back(i == -kBelow ? 1 : i == links + kBelow ? heavy : 2e-4);
      const int at = i + kBelow;
      if (at > 0) rods.push_back({at - 1, at, l});
    }
    Scene s = under_gravity(bare::scene(x, mass, rods));
    s.stiffness = {1e4, 1e4, 1e4};
    s.damping = 4;
    s.colliders = {{cylinder, {}, kFriction}};
    s.dt = 1.0 / 128;
    return s;
  }
  /// Speed of the heavy end [m/s].
  double speed(const std::string& solver, const Shape& cylinder, double heavy,
               int seconds = 2) const {
    const Scene s = scene(cylinder, heavy);
    return Simulation(s, solver, 128 * seconds).v(static_cast<int>(s.start.x.size()) - 1).norm();
  }
};

}  // namespace taut
