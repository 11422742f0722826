#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/solver/layout/order.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"

namespace taut {

/// A Gauss-Seidel sweep over any links of packed particles: phases of tiles of batches of kLanes
/// independent links. In each colour, links whose ends have the same share come first, because they
/// need no table of shares, and near links come before far ones. Links that do not fill a batch are
/// far; their last batch is filled up with links between the two spare particles of Layout::packed,
/// which do nothing.
template <class Real>
class ColourBatches {
 public:
  /// Precondition: the layout is packed.
  ColourBatches(const std::vector<Phase>&, std::span<const double> w, double omega,
                const Layout& layout, const Compliances& = {});
  ColourBatches(ColourBatches&&) = default;
  ColourBatches(const ColourBatches&) = delete;  // it points into itself

  std::size_t phases() const { return phase_.size() - 1; }
  /// Number of tiles in a phase.
  std::size_t parts(std::size_t phase) const { return phase_[phase + 1] - phase_[phase]; }
  std::span<const BatchRun<Real>> runs(std::size_t phase, std::size_t tile) const {
    const std::size_t t = phase_[phase] + tile;
    return {runs_.data() + tile_[t], runs_.data() + tile_[t + 1]};
  }

  /// The links in the order in which the sweep visits them.
  std::vector<DistanceConstraint<Real>> order(const Layout&) const;
  /// Sets the rest lengths of damped links by their lengths at x_t, x y z 0 of each particle.
  void damp(const Real* x);
  /// Sets all multipliers to 0.
  void clear_multipliers() { std::ranges::fill(multipliers_, Real(0)); }
  std::size_t bytes() const;

 private:
  using Constraints = std::vector<CompliantConstraint<Real>>;
  /// First and last particle in memory.
  struct Extent {
    std::size_t first, last;
  };
  void add_tile(const Tile&, std::span<const double> w, double omega, const Layout&,
                const Compliances&);
  void add_colour(Constraints, bool damped, std::size_t first, const Layout&);
  template <class Number>
  void add_run(std::span<const CompliantConstraint<Real>>, bool damped, bool equal,
               std::size_t first, const Layout&, std::vector<Batch<Real, Number>>& to);
  void look_ahead();
  /// A damped link, in a lane of a batch.
  struct Damped {
    bool near;
    std::size_t batch, lane;
    std::size_t a, b;  ///< places of its ends in x
    Real rest;         ///< m, without damping
  };

  std::vector<NearBatch<Real>> near_;
  std::vector<FarBatch<Real>> far_;
  std::vector<Extent> extents_;  ///< [tiles]
  std::vector<Damped> damped_;   ///< empty: no damping
  Real damped_share_ = 0;        ///< Compliances::damped
  std::vector<Real> shares_, multipliers_;
  std::vector<BatchRun<Real>> runs_;
  /// First run of each tile, first tile of each phase, and the ends.
  std::vector<std::size_t> tile_, phase_;
};

}  // namespace taut
