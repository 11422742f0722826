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

/// Keeps a vertex no farther from a pin than it is along the cloth at rest.
struct Tether {
  int vertex = 0, pin = 0;
  double length = 0;  ///< m
};

/// Long-range attachments (Kim, Chentanez, Mueller-Fischer: Long Range Attachments, SCA 2012).
/// Every vertex that can move gets one to the nearest pin of each group of linked pins, at most
/// four in all. The length is the straight distance on a sheet that keeps flat distances. Elsewhere
/// it is the shortest path along structural and shear links, an upper bound of the geodesic.
std::vector<Tether> make_tethers(const Scene&);

/// Pulls back particles that are beyond their tether and leaves slack tethers alone. The limit is
/// one-sided and ignores masses: the pin does not move. This carries the weight of a hanging sheet
/// to the pins in one sweep instead of one row per sweep, and stiffens cloth that hangs in folds:
/// see core/README.md. The k-th tethers of all particles are stored in the particles' own layout,
/// so that lanes process them as they process particles.
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
  std::vector<Tether> tethers_;  ///< sorted by vertex
  bool pins_move_, placed_ = false;
  void (*pull_)(const ParticleSpan<Real>&, std::span<const TetherTable<Real>>);
  std::vector<Points<Real>> pins_, lengths_;  ///< [tethers of a particle]; TetherTable's data
  std::vector<TetherTable<Real>> tables_;
};

}  // namespace taut
