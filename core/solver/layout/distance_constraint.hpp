#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "core/model/mesh.hpp"
#include "core/solver/simd/distance.hpp"

namespace taut {

/// A link as the sweeps see it: who, how long, and who moves by how much.
template <class Real>
struct DistanceConstraint {
  int a = 0, b = 0;               ///< vertices
  Real rest = 0;                  ///< m, > 0
  Real share_a = 0, share_b = 0;  ///< of the correction; see project_distance
};

/// How stiff links are.
///
/// A family with stiffness K [N/m] acts as a spring does under implicit Euler. One isolated link
/// has to lose the fraction c = K h^2 (w1 + w2) / (1 + K h^2 (w1 + w2)) of its stretch in a substep
/// of h seconds, so each of n sweeps removes 1 - (1 - c)^(1/n). Hence K means the same for every
/// time step and every number of sweeps, and a mass m hanging from such a link stretches it by m g
/// / K (tests/solver/stiffness_test.cpp). K = inf is Jakobsen's rigid link: c = 1.
struct Stiffness {
  std::array<double, kFamilies.size()> of_family{};  ///< K [N/m]
  double omega = 1;                                  ///< over-relaxation
  double substep = 0;                                ///< h [s]
  int iterations = 1;                                ///< n
};

/// Share of the correction that one sweep applies to a link of this family with w1 + w2 = w.
inline double relaxation_weight(const Stiffness& stiffness, Family family, double w) {
  const double k = stiffness.of_family[static_cast<std::size_t>(family)];
  if (std::isinf(k) || stiffness.iterations == 0) return stiffness.omega;
  // 1 - c = 1 / (1 + K h^2 w); expm1 and log1p keep the digits of very soft links
  const double ratio = k * stiffness.substep * stiffness.substep * w;
  return -stiffness.omega * std::expm1(-std::log1p(ratio) / stiffness.iterations);
}

/// Whether the link has two ends and at least one of them can move. w: inverse masses [1/kg].
inline bool moves(const Link& link, std::span<const double> w) {
  const auto inverse = [&](int v) { return w[static_cast<std::size_t>(v)]; };
  return link.a != link.b && inverse(link.a) + inverse(link.b) > 0;
}

/// Those of `links` that move, in the given order.
template <class Real>
std::vector<DistanceConstraint<Real>> make_distance_constraints(std::span<const Link> links,
                                                                std::span<const double> w,
                                                                const Stiffness& stiffness) {
  std::vector<DistanceConstraint<Real>> constraints;
  constraints.reserve(links.size());
  for (const Link& link : links) {
    const double wa = w[static_cast<std::size_t>(link.a)], wb = w[static_cast<std::size_t>(link.b)];
    if (!moves(link, w)) continue;
    const double weight = relaxation_weight(stiffness, link.family, wa + wb);
    constraints.push_back({link.a, link.b, static_cast<Real>(std::max(link.rest, kTinyLength)),
                           static_cast<Real>(weight * (wa / (wa + wb))),
                           static_cast<Real>(weight * (wb / (wa + wb)))});
  }
  return constraints;
}

}  // namespace taut
