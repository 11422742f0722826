#include "core/solver/layout/colour_batches.hpp"

#include <algorithm>
#include <map>

namespace taut {

template <class Real>
ColourBatches<Real>::ColourBatches(const std::vector<Phase>& phases, std::span<const double> w,
                                   double omega, const Layout& layout) {
  phase_.push_back(0), tile_.push_back(0);
  for (const Phase& phase : phases) {
    for (const Tile& tile : phase) {
      for (const Colour& colour : tile)
        add_colour(make_distance_constraints<Real>(colour, w, omega), layout);
      tile_.push_back(runs_.size());
    }
    phase_.push_back(tile_.size() - 1);
  }
  // Only now do the arrays stay where they are.
  std::size_t batch = 0, share = 0;
  for (BatchRun<Real>& run : runs_) {
    run.batches = batches_.data() + batch;
    batch += run.count;
    if (run.equal_share == Real(-1)) {
      run.shares = shares_.data() + share;
      share += 2 * kLanes * run.count;
    }
  }
}

template <class Real>
void ColourBatches<Real>::add_colour(std::vector<DistanceConstraint<Real>> constraints,
                                     const Layout& layout) {
  std::map<Real, int> votes;  // equal shares, by how many links have them
  for (const DistanceConstraint<Real>& c : constraints)
    if (c.share_a == c.share_b) ++votes[c.share_a];
  const auto most = std::max_element(
      votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto equal =
      std::stable_partition(constraints.begin(), constraints.end(), [&](const auto& s) {
        return most != votes.end() && s.share_a == most->first && s.share_b == most->first;
      });
  // Equal ones that do not fill a batch go with the others.
  const auto whole = constraints.begin() + (equal - constraints.begin()) / kLanes * kLanes;
  add_run({constraints.begin(), whole}, true, layout);
  add_run({whole, constraints.end()}, false, layout);
}

template <class Real>
void ColourBatches<Real>::add_run(std::span<const DistanceConstraint<Real>> constraints, bool equal,
                                  const Layout& layout) {
  if (constraints.empty()) return;
  const auto slot = [&](int v) {
    return static_cast<std::uint32_t>(layout.slot(static_cast<std::size_t>(v)));
  };
  const auto spare = static_cast<std::uint32_t>(4 * layout.size());
  BatchRun<Real> run{};
  run.equal_share = equal ? constraints.front().share_a : Real(-1);
  for (std::size_t first = 0; first < constraints.size(); first += kLanes, ++run.count) {
    Batch<Real>& batch = batches_.emplace_back();
    const std::size_t base = shares_.size();
    if (!equal) shares_.resize(base + 2 * kLanes);
    for (std::size_t l = 0; l < kLanes; ++l) {
      const bool real = first + l < constraints.size();
      const DistanceConstraint<Real> c = real ? constraints[first + l] : DistanceConstraint<Real>{};
      batch.a[l] = real ? slot(c.a) : spare;
      batch.b[l] = real ? slot(c.b) : spare + 4;
      batch.rest[l] = real ? c.rest : static_cast<Real>(kTinyLength);
      if (!equal) shares_[base + l] = c.share_a, shares_[base + kLanes + l] = c.share_b;
    }
  }
  runs_.push_back(run);
}

template <class Real>
std::vector<DistanceConstraint<Real>> ColourBatches<Real>::order(const Layout& layout) const {
  std::vector<int> vertex(layout.size() + 2);
  for (std::size_t i = 0; i < layout.size(); ++i) vertex[layout.slot(i) / 4] = static_cast<int>(i);
  std::vector<DistanceConstraint<Real>> constraints;
  for (const BatchRun<Real>& run : runs_)
    for (std::size_t n = 0; n < run.count; ++n)
      for (std::size_t l = 0; l < kLanes; ++l) {
        const Batch<Real>& batch = run.batches[n];
        const Real* const shares = run.shares ? run.shares + 2 * kLanes * n + l : nullptr;
        const DistanceConstraint<Real> c{vertex[batch.a[l] / 4], vertex[batch.b[l] / 4],
                                         batch.rest[l], shares ? shares[0] : run.equal_share,
                                         shares ? shares[kLanes] : run.equal_share};
        if (c.share_a != 0 || c.share_b != 0) constraints.push_back(c);
      }
  return constraints;
}

template <class Real>
std::size_t ColourBatches<Real>::bytes() const {
  return sizeof *this + batches_.size() * sizeof batches_[0] + shares_.size() * sizeof(Real) +
         runs_.size() * sizeof runs_[0] + (tile_.size() + phase_.size()) * sizeof tile_[0];
}

template class ColourBatches<float>;
template class ColourBatches<double>;

}  // namespace taut
