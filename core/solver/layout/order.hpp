#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/model/scene.hpp"
#include "core/solver/simd/distance.hpp"

namespace taut {

/// A link of a sweep: its vertices, its rest length, and how much each end moves.
template <class Real>
struct DistanceConstraint {
  int a = 0, b = 0;               ///< vertices
  Real rest = 0;                  ///< m, > 0
  Real share_a = 0, share_b = 0;  ///< shares of the correction; see project_distance
};

/// A link that may be compliant. share: of its multiplier, 0 if it has none; see compliant_excess.
template <class Real>
struct CompliantConstraint : DistanceConstraint<Real> {
  Real share = 0;
};

/// How links comply. Multipliers that are 0 at the start of every sweep are not needed: without
/// them, a link of shares w/(w1 + w2 + a) is projected as a rigid one is.
struct Compliances {
  /// compliance/h^2 of a substep [1/kg] by family; 0: rigid.
  std::array<double, kFamilies.size()> over_h2{};
  bool multipliers = false;  ///< XPBD's, kept from sweep to sweep
  /// LinkDamping::share() of links that comply, whose compliance is that of LinkDamping::stiffer().
  double damped = 0;
};

/// The rest length of a damped link, from that without damping and the ends x_t: x y z each.
template <class Real>
Real damped_rest(Real rest, const Real* a, const Real* b, Real share) {
  const Real way[]{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  return rest + share * (std::sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]) - rest);
}

/// Whether the link has two ends and at least one of them can move. w: inverse masses [1/kg].
inline bool moves(const Link& link, std::span<const double> w) {
  const auto inverse = [&](int v) { return w[static_cast<std::size_t>(v)]; };
  return link.a != link.b && inverse(link.a) + inverse(link.b) > 0;
}

/// Constraints for those of `links` that can move, in the given order. omega: relaxation factor.
template <class Real>
std::vector<CompliantConstraint<Real>> make_compliant_constraints(std::span<const Link> links,
                                                                  std::span<const double> w,
                                                                  double omega,
                                                                  const Compliances& compliances) {
  std::vector<CompliantConstraint<Real>> constraints;
  constraints.reserve(links.size());
  for (const Link& link : links) {
    const double wa = w[static_cast<std::size_t>(link.a)], wb = w[static_cast<std::size_t>(link.b)];
    if (!moves(link, w)) continue;
    const double soft = compliances.over_h2[static_cast<std::size_t>(link.family)],
                 all = wa + wb + soft;
    constraints.push_back(
        {{link.a, link.b, static_cast<Real>(std::max(link.rest, kTinyLength)),
          static_cast<Real>(omega * (wa / all)), static_cast<Real>(omega * (wb / all))},
         static_cast<Real>(compliances.multipliers ? soft / all : 0)});
  }
  return constraints;
}
template <class Real>
std::vector<DistanceConstraint<Real>> make_distance_constraints(
    std::span<const Link> links, std::span<const double> w, double omega,
    const Compliances& compliances = {}) {
  const auto all = make_compliant_constraints<Real>(links, w, omega, compliances);
  return {all.begin(), all.end()};
}

/// Rest lengths of the damped ones of such constraints (core/model/link_damping.hpp).
template <class Real>
class DampedConstraints {
 public:
  DampedConstraints(std::span<const Link> links, std::span<const double> w,
                    const Compliances& compliances)
      : share_(static_cast<Real>(compliances.damped)) {
    if (compliances.damped == 0) return;
    std::size_t next = 0;
    for (const Link& link : links) {
      if (!moves(link, w)) continue;
      if (compliances.over_h2[static_cast<std::size_t>(link.family)] > 0)
        all_.push_back({next, static_cast<Real>(std::max(link.rest, kTinyLength))});
      ++next;
    }
  }
  /// Sets the rest lengths by the lengths at x_t, x y z 0 of each vertex.
  template <class Constraint>
  void begin(std::vector<Constraint>& constraints, const Real* x) const {
    for (const auto& [at, rest] : all_) {
      Constraint& c = constraints[at];
      c.rest = damped_rest(rest, x + 4 * c.a, x + 4 * c.b, share_);
    }
  }
  std::size_t bytes() const { return all_.size() * sizeof(Damped); }

 private:
  struct Damped {
    std::size_t at;  ///< index of the constraint
    Real rest;       ///< m, without damping
  };
  Real share_;
  std::vector<Damped> all_;  ///< empty: no damping
};

/// Whether no two vertices can be farther apart than in the flat sheet: true of a regular sheet
/// with shear links. Without shear links a sheet is a net: pulled along its diagonals it grows
/// longer, up to the path along its links.
inline bool keeps_flat_distances(const Scene& scene) {
  return scene.mesh.grid && std::ranges::none_of(scene.links, is_seam) &&
         std::any_of(scene.links.begin(), scene.links.end(),
                     [](const Link& l) { return l.family == Family::shear; });
}

/// The order in which Gauss-Seidel visits the links. It decides convergence, stability under
/// substeps and what can run in parallel; results/benchmarks/default-setting.md compares the
/// orders.
enum class Order {
  mesh,      ///< as the scene lists them
  coloured,  ///< independent groups, tile by tile
  reversed,  ///< the scene's list backwards
  random,    ///< shuffled once, by seed
  jolt       ///< as Jolt Physics' soft body sorts its edges
};

/// Links that share no vertex, so that their order among themselves does not matter.
using Colour = std::vector<Link>;
/// A neighbourhood small enough for the first-level cache: its colours, one after the other.
using Tile = std::vector<Colour>;
/// Tiles that share no vertex, so that they can run at the same time.
using Phase = std::vector<Tile>;

/// Sorts links into phases of tiles of colours, family after family within a tile. Depends only on
/// the links and the mesh.
std::vector<Phase> colour(std::span<const Link>, const Mesh&);

/// Position in memory of each vertex, such that vertices of a tile are neighbours.
std::vector<std::uint32_t> tile_ranks(const Mesh&);

/// All links of the phases, one after another.
std::vector<Link> flatten(const std::vector<Phase>&);

/// The scene's links as Jolt Physics 5.3 to 5.5 sorts the edges of a soft body that starts at
/// scene.start (Optimize()).
std::vector<Link> jolt_order(const Scene&);

/// The scene's links in the given order; seed is for Order::random.
std::vector<Link> ordered(const Scene&, Order, std::uint32_t seed);

}  // namespace taut
