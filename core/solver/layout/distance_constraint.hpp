#pragma once

#include <algorithm>
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

/// Whether the link has two ends and at least one of them can move. w: inverse masses [1/kg].
inline bool moves(const Link& link, std::span<const double> w) {
  const auto inverse = [&](int v) { return w[static_cast<std::size_t>(v)]; };
  return link.a != link.b && inverse(link.a) + inverse(link.b) > 0;
}

/// Those of `links` that move, in the given order. omega: relaxation factor.
template <class Real>
std::vector<DistanceConstraint<Real>> make_distance_constraints(std::span<const Link> links,
                                                                std::span<const double> w,
                                                                double omega) {
  std::vector<DistanceConstraint<Real>> constraints;
  constraints.reserve(links.size());
  for (const Link& link : links) {
    const double wa = w[static_cast<std::size_t>(link.a)], wb = w[static_cast<std::size_t>(link.b)];
    if (!moves(link, w)) continue;
    constraints.push_back({link.a, link.b, static_cast<Real>(std::max(link.rest, kTinyLength)),
                           static_cast<Real>(omega * (wa / (wa + wb))),
                           static_cast<Real>(omega * (wb / (wa + wb)))});
  }
  return constraints;
}

}  // namespace taut
