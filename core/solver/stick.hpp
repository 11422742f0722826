#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "core/model/mesh.hpp"

namespace taut {

/// A link as the sweeps see it: who, how long, and who moves by how much.
template <class Real>
struct Stick {
  int a = 0, b = 0;               ///< vertices
  Real rest = 0;                  ///< m, > 0
  Real share_a = 0, share_b = 0;  ///< of the correction; see project_distance
};

/// How firmly links hold.
///
/// A family with stiffness K [N/m] acts as a spring does under implicit Euler. One isolated link
/// has to lose the fraction c = K h^2 (w1 + w2) / (1 + K h^2 (w1 + w2)) of its stretch in a substep
/// of h seconds, so each of n sweeps removes 1 - (1 - c)^(1/n). Hence K means the same for every
/// time step and every number of sweeps, and a mass m hanging from such a link stretches it by m g
/// / K (tests/solver/stiffness_test.cpp). K = inf is Jakobsen's stick: c = 1.
struct Firmness {
  std::array<double, kFamilies.size()> stiffness{};  ///< N/m by family
  double omega = 1;                                  ///< over-relaxation
  double substep = 0;                                ///< h [s]
  int iterations = 1;                                ///< n
};

/// Whether the link has two ends and at least one of them can move.
inline bool moves(const Link& link, std::span<const double> w) {
  const auto inverse = [&](int v) { return w[static_cast<std::size_t>(v)]; };
  return link.a != link.b && inverse(link.a) + inverse(link.b) > 0;
}

/// Those of `links` that move, in the given order.
template <class Real>
std::vector<Stick<Real>> make_sticks(std::span<const Link> links, std::span<const double> w,
                                     const Firmness&);

/// Share of the correction that one sweep applies to a link of this family with w1 + w2 = w.
double softened(const Firmness&, Family, double w);

}  // namespace taut
