#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/scene.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/distance.hpp"
#include "core/solver/simd/kernels.hpp"

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
/// one row per sweep, and stiffens what hangs in folds: see core/README.md. Each particle's k-th
/// tether lies where the particle does, so that lanes take them as they take particles.
template <class Real>
class TetherPass final : public Pass<Real> {
 public:
  TetherPass(const Scene& scene, std::span<const Tether> tethers, Projection projection, Simd simd)
      : tethers_(tethers.begin(), tethers.end()),
        pins_move_(!scene.pin_motions.empty()),
        pull_(kernels<Real>(simd).tethers[static_cast<int>(projection)]) {}

  void restart() override { placed_ = false; }

  void begin(Particles<Real>& p, double, double) override {
    if (placed_ && !pins_move_) return;
    int vertex = -1;
    std::size_t k = 0;
    for (const Tether& t : tethers_) {
      k = t.vertex == vertex ? k + 1 : 0;
      vertex = t.vertex;
      if (k == pins_.size()) {
        pins_.emplace_back(p.layout);
        lengths_.emplace_back(p.layout);
        lengths_[k].fill(static_cast<Real>(kNoTether));
      }
      const auto length = static_cast<Real>(std::max(t.length, kTinyLength));
      pins_[k].set(to_index(t.vertex), p.x[to_index(t.pin)]);
      lengths_[k].set(to_index(t.vertex), {length, 0, 0});
    }
    tables_.clear();
    for (k = 0; k < pins_.size(); ++k) tables_.push_back({pins_[k].data(), lengths_[k].data()});
    placed_ = true;
  }

  void apply(Particles<Real>& p, double, double) override {
    pull_({p.x.data(), p.previous.data(), p.layout->sheet(), p.size()}, tables_);
  }

  std::vector<PassCost> cost() const override {
    std::size_t bytes = tethers_.size() * sizeof tethers_[0];
    for (const auto* points : {&pins_, &lengths_})
      for (const Points<Real>& one : *points) bytes += one.bytes();
    return {{.pass = "tethers", .items = tethers_.size(), .bytes = bytes, .projections = true}};
  }

 private:
  std::vector<Tether> tethers_;  ///< vertex after vertex
  bool pins_move_, placed_ = false;
  void (*pull_)(const ParticleSpan<Real>&, std::span<const TetherTable<Real>>);
  std::vector<Points<Real>> pins_, lengths_;  ///< [tethers of a particle], as TetherTable has them
  std::vector<TetherTable<Real>> tables_;
};

}  // namespace taut
