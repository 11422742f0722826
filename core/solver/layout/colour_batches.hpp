#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/solver/layout/distance_constraint.hpp"
#include "core/solver/layout/order.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"

namespace taut {

/// A Gauss-Seidel sweep over any links of packed particles: phases of tiles of batches of kLanes
/// independent links, the last batch of a colour filled up with links that do nothing between the
/// two spare particles of Layout::packed. Batches of links whose ends have the same share
/// come first in each colour and need no table of shares.
template <class Real>
class ColourBatches {
 public:
  /// layout: packed.
  ColourBatches(const std::vector<Phase>&, std::span<const double> w, double omega,
                const Layout& layout);
  ColourBatches(ColourBatches&&) = default;
  ColourBatches(const ColourBatches&) = delete;  // it points into itself

  std::size_t phases() const { return phase_.size() - 1; }
  std::size_t tiles(std::size_t phase) const { return phase_[phase + 1] - phase_[phase]; }
  std::span<const BatchRun<Real>> runs(std::size_t phase, std::size_t tile) const {
    const std::size_t t = phase_[phase] + tile;
    return {runs_.data() + tile_[t], runs_.data() + tile_[t + 1]};
  }

  /// The links in the order in which the sweep visits them.
  std::vector<DistanceConstraint<Real>> order(const Layout&) const;
  std::size_t bytes() const;

 private:
  void add_colour(std::vector<DistanceConstraint<Real>> constraints, const Layout&);
  void add_run(std::span<const DistanceConstraint<Real>> constraints, bool equal, const Layout&);

  std::vector<Batch<Real>> batches_;
  std::vector<Real> shares_;
  std::vector<BatchRun<Real>> runs_;
  std::vector<std::size_t> tile_, phase_;  ///< where each begins, and the end
};

}  // namespace taut
