#include "core/solver/batch.hpp"

#include <algorithm>
#include <map>

#include "core/solver/distance.hpp"

namespace taut {

template <class Real>
BatchPlan<Real>::BatchPlan(const std::vector<Phase>& phases, std::span<const double> w,
                           const Firmness& firm, const Layout& layout) {
  phase_.push_back(0), tile_.push_back(0);
  for (const Phase& phase : phases) {
    for (const Tile& tile : phase) {
      for (const Colour& colour : tile) add_colour(make_sticks<Real>(colour, w, firm), layout);
      tile_.push_back(runs_.size());
    }
    phase_.push_back(tile_.size() - 1);
  }
  // Only now do the arrays stay where they are.
  std::size_t batch = 0, share = 0;
  for (BatchRun<Real>& run : runs_) {
    run.batches = batches_.data() + batch;
    batch += run.count;
    if (run.half == Real(-1)) {
      run.shares = shares_.data() + share;
      share += 2 * kLanes * run.count;
    }
  }
}

template <class Real>
void BatchPlan<Real>::add_colour(std::vector<Stick<Real>> sticks, const Layout& layout) {
  std::map<Real, int> votes;  // equal shares, by how many links have them
  for (const Stick<Real>& s : sticks)
    if (s.share_a == s.share_b) ++votes[s.share_a];
  const auto most = std::max_element(
      votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto equal = std::stable_partition(sticks.begin(), sticks.end(), [&](const auto& s) {
    return most != votes.end() && s.share_a == most->first && s.share_b == most->first;
  });
  // Equal ones that do not fill a batch go with the others.
  const auto whole = sticks.begin() + (equal - sticks.begin()) / kLanes * kLanes;
  add_run({sticks.begin(), whole}, true, layout);
  add_run({whole, sticks.end()}, false, layout);
}

template <class Real>
void BatchPlan<Real>::add_run(std::span<const Stick<Real>> sticks, bool equal,
                              const Layout& layout) {
  if (sticks.empty()) return;
  const auto slot = [&](int v) {
    return static_cast<std::uint32_t>(layout.slot(static_cast<std::size_t>(v)));
  };
  const auto spare = static_cast<std::uint32_t>(4 * layout.size());
  BatchRun<Real> run{};
  run.half = equal ? sticks.front().share_a : Real(-1);
  for (std::size_t first = 0; first < sticks.size(); first += kLanes, ++run.count) {
    Batch<Real>& batch = batches_.emplace_back();
    const std::size_t base = shares_.size();
    if (!equal) shares_.resize(base + 2 * kLanes);
    for (std::size_t l = 0; l < kLanes; ++l) {
      const bool real = first + l < sticks.size();
      const Stick<Real> s = real ? sticks[first + l] : Stick<Real>{};
      batch.a[l] = real ? slot(s.a) : spare;
      batch.b[l] = real ? slot(s.b) : spare + 4;
      batch.rest[l] = real ? s.rest : static_cast<Real>(kTinyLength);
      if (!equal) shares_[base + l] = s.share_a, shares_[base + kLanes + l] = s.share_b;
    }
  }
  runs_.push_back(run);
}

template <class Real>
std::vector<Stick<Real>> BatchPlan<Real>::order(const Layout& layout) const {
  std::vector<int> vertex(layout.size() + 2);
  for (std::size_t i = 0; i < layout.size(); ++i) vertex[layout.slot(i) / 4] = static_cast<int>(i);
  std::vector<Stick<Real>> sticks;
  for (const BatchRun<Real>& run : runs_)
    for (std::size_t n = 0; n < run.count; ++n)
      for (std::size_t l = 0; l < kLanes; ++l) {
        const Batch<Real>& batch = run.batches[n];
        const Real* const shares = run.shares ? run.shares + 2 * kLanes * n + l : nullptr;
        const Stick<Real> s{vertex[batch.a[l] / 4], vertex[batch.b[l] / 4], batch.rest[l],
                            shares ? shares[0] : run.half, shares ? shares[kLanes] : run.half};
        if (s.share_a != 0 || s.share_b != 0) sticks.push_back(s);
      }
  return sticks;
}

template <class Real>
std::size_t BatchPlan<Real>::bytes() const {
  return sizeof *this + batches_.size() * sizeof batches_[0] + shares_.size() * sizeof(Real) +
         runs_.size() * sizeof runs_[0] + (tile_.size() + phase_.size()) * sizeof tile_[0];
}

template class BatchPlan<float>;
template class BatchPlan<double>;

}  // namespace taut
