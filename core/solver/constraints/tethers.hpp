#pragma once

#include "core/model/scene.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/distance.hpp"

namespace taut {

/// No vertex may be farther from a pin than along the cloth at rest.
struct Tether {
  int vertex = 0, pin = 0;
  double length = 0;  ///< m
};

/// Long-range attachments (Kim, Chentanez, Mueller-Fischer: Long Range Attachments, SCA 2012): for
/// every vertex that can move, one to the nearest pin of each group of linked pins, at most
/// four. Length: the straight line on a sheet that keeps flat distances, else the shortest way
/// along structural and shear links, an upper bound of the geodesic.
std::vector<Tether> make_tethers(const Scene&);

/// Pulls back what is beyond its tether; does nothing to a slack one. One-sided and without mass:
/// the pin does not move. It carries a hanging sheet's weight to the pins in one sweep instead of
/// one row per sweep, and stiffens what hangs in folds: see core/README.md.
template <class Real, Projection kind>
class TetherPass final : public Pass<Real> {
 public:
  explicit TetherPass(std::vector<Tether> tethers) {
    for (const Tether& t : tethers)
      tethers_.push_back({t.vertex, t.pin, static_cast<Real>(t.length)});
  }

  void apply(Particles<Real>& p, double, double) override {
    for (const Short& t : tethers_) {
      const auto at = p.x[static_cast<std::size_t>(t.pin)];
      auto x = p.x[static_cast<std::size_t>(t.vertex)];
      if ((x - at).squaredNorm() <= t.length * t.length) continue;
      Vec3T<Real> pin{at.x(), at.y(), at.z()}, end{x.x(), x.y(), x.z()};
      project_distance<kind>(pin, end, t.length, Real(0), Real(1));
      p.x.set(static_cast<std::size_t>(t.vertex), {end.x, end.y, end.z});
    }
  }

  std::vector<PassCost> cost() const override {
    return {{.pass = "tethers",
             .items = tethers_.size(),
             .bytes = tethers_.size() * sizeof(Short),
             .projections = true}};
  }

 private:
  struct Short {
    int vertex, pin;
    Real length;
  };
  std::vector<Short> tethers_;
};

}  // namespace taut
