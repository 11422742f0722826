#include "core/solver/layout/colour_batches.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <type_traits>

#include "core/model/index.hpp"

namespace taut {

namespace {

/// Near ends are 16-bit numbers, counted from kBefore particles before their tile. Most
/// neighbouring tiles come later, and so lie within this range.
constexpr std::size_t kBefore = 16384, kNear = std::numeric_limits<std::uint16_t>::max();

std::size_t place(const Layout& layout, int v) { return layout.slot(to_index(v)) / 4; }

}  // namespace

template <class Real>
ColourBatches<Real>::ColourBatches(const std::vector<Phase>& phases, std::span<const double> w,
                                   double omega, const Layout& layout,
                                   const Compliances& compliances)
    : damped_share_(static_cast<Real>(compliances.damped)) {
  phase_.push_back(0);
  tile_.push_back(0);
  for (const Phase& phase : phases) {
    for (const Tile& tile : phase) {
      add_tile(tile, w, omega, layout, compliances);
      tile_.push_back(runs_.size());
    }
    phase_.push_back(tile_.size() - 1);
  }
  // Pointers are set last, when the arrays no longer move.
  std::size_t near = 0, far = 0, share = 0, multiplier = 0;
  for (BatchRun<Real>& run : runs_) {
    if (run.near) {
      run.near = near_.data() + near;
      near += run.count;
    } else {
      run.far = far_.data() + far;
      far += run.count;
    }
    if (run.shares) {
      run.shares = shares_.data() + share;
      share += (run.multipliers ? 3 : 2) * kLanes * run.count;
    }
    if (run.multipliers) {
      run.multipliers = multipliers_.data() + multiplier;
      multiplier += kLanes * run.count;
    }
  }
  look_ahead();
}

template <class Real>
void ColourBatches<Real>::add_tile(const Tile& tile, std::span<const double> w, double omega,
                                   const Layout& layout, const Compliances& compliances) {
  Extent extent{layout.size(), 0};
  for (const Colour& colour : tile)
    for (const Link& link : colour) {
      const std::size_t at = place(layout, link.a);
      extent = {std::min(extent.first, at), std::max(extent.last, at)};
    }
  extents_.push_back(extent);
  for (const Colour& colour : tile) {  // of one family
    const bool damped = compliances.damped > 0 && !colour.empty() &&
                        compliances.over_h2[static_cast<std::size_t>(colour.front().family)] > 0;
    add_colour(make_compliant_constraints<Real>(colour, w, omega, compliances), damped,
               extent.first - std::min(extent.first, kBefore), layout);
  }
}

template <class Real>
void ColourBatches<Real>::add_colour(Constraints constraints, bool damped, std::size_t first,
                                     const Layout& layout) {
  // Votes for the most common equal share, with the share of its multiplier.
  std::map<std::pair<Real, Real>, int> votes;
  for (const CompliantConstraint<Real>& c : constraints)
    if (c.share_a == c.share_b) ++votes[{c.share_a, c.share}];
  const auto most = std::max_element(
      votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto near = [&](int v) {
    return place(layout, v) >= first && place(layout, v) - first <= kNear;
  };
  const auto whole = [](auto begin, auto end) { return begin + (end - begin) / kLanes * kLanes; };
  const auto begin = constraints.begin(), end = constraints.end();
  const auto far =
      std::stable_partition(begin, end, [&](const auto& c) { return near(c.a) && near(c.b); });
  const auto unequal = std::stable_partition(begin, far, [&](const auto& c) {
    return most != votes.end() && c.share_a == c.share_b &&
           std::pair(c.share_a, c.share) == most->first;
  });
  const auto equal_end = whole(begin, unequal), near_end = whole(equal_end, far);
  add_run({begin, equal_end}, damped, true, first, layout, near_);
  add_run({equal_end, near_end}, damped, false, first, layout, near_);
  add_run({near_end, end}, damped, false, 0, layout, far_);
}

template <class Real>
template <class Number>
void ColourBatches<Real>::add_run(std::span<const CompliantConstraint<Real>> constraints,
                                  bool damped, bool equal, std::size_t first, const Layout& layout,
                                  std::vector<Batch<Real, Number>>& to) {
  if (constraints.empty()) return;
  BatchRun<Real> run{};
  run.first = first;
  run.equal_share = equal ? constraints.front().share_a : Real(0);
  run.multiplier_share = equal ? constraints.front().share : Real(0);
  const bool compliant = constraints.front().share > 0;  // a colour has one family
  const std::size_t ends = compliant ? 3 : 2;
  for (std::size_t next = 0; next < constraints.size(); next += kLanes, ++run.count) {
    Batch<Real, Number>& batch = to.emplace_back();
    const std::size_t base = shares_.size();
    if (!equal) shares_.resize(base + ends * kLanes);
    if (compliant) multipliers_.resize(multipliers_.size() + kLanes);
    for (std::size_t l = 0; l < kLanes; ++l) {
      const bool real = next + l < constraints.size();
      const CompliantConstraint<Real> c =
          real ? constraints[next + l] : CompliantConstraint<Real>{};
      batch.a[l] = static_cast<Number>((real ? place(layout, c.a) : layout.size()) - first);
      batch.b[l] = static_cast<Number>((real ? place(layout, c.b) : layout.size() + 1) - first);
      batch.rest[l] = real ? c.rest : static_cast<Real>(kTinyLength);
      if (damped && real)
        damped_.push_back({std::is_same_v<Number, std::uint16_t>, to.size() - 1, l,
                           layout.slot(to_index(c.a)), layout.slot(to_index(c.b)), c.rest});
      if (!equal) {
        shares_[base + l] = c.share_a;
        shares_[base + kLanes + l] = c.share_b;
      }
      if (!equal && compliant) shares_[base + 2 * kLanes + l] = c.share;
    }
  }
  // These pointers are not final; so far they only say which arrays there are.
  if constexpr (std::is_same_v<Number, std::uint16_t>)
    run.near = to.data();
  else
    run.far = to.data();
  run.shares = equal ? nullptr : shares_.data();
  run.multipliers = compliant ? multipliers_.data() : nullptr;
  runs_.push_back(run);
}

template <class Real>
void ColourBatches<Real>::damp(const Real* x) {
  for (const auto& [near, batch, lane, a, b, rest] : damped_)
    (near ? near_[batch].rest : far_[batch].rest)[lane] =
        damped_rest(rest, x + a, x + b, damped_share_);
}

/// Makes the runs of each tile prefetch the particles of the next tile, some with each batch.
template <class Real>
void ColourBatches<Real>::look_ahead() {
  constexpr std::size_t line = 64 / sizeof(Real);
  for (std::size_t tile = 0; tile + 1 < extents_.size(); ++tile) {
    const Extent& next = extents_[tile + 1];
    std::size_t ahead = 4 * next.first;
    for (std::size_t r = tile_[tile]; r < tile_[tile + 1] && ahead <= 4 * next.last; ++r) {
      runs_[r].ahead = ahead;
      runs_[r].stride = line;
      ahead += line * runs_[r].count;
    }
  }
}

template <class Real>
std::vector<DistanceConstraint<Real>> ColourBatches<Real>::order(const Layout& layout) const {
  std::vector<int> vertex(layout.size() + 2);
  for (std::size_t i = 0; i < layout.size(); ++i) vertex[layout.slot(i) / 4] = static_cast<int>(i);
  std::vector<DistanceConstraint<Real>> constraints;
  for (const BatchRun<Real>& run : runs_)
    for (std::size_t n = 0; n < run.count; ++n)
      for (std::size_t l = 0; l < kLanes; ++l) {
        const Real* const shares =
            run.shares ? run.shares + (run.multipliers ? 3 : 2) * kLanes * n + l : nullptr;
        const auto link = [&](const auto& batch) -> DistanceConstraint<Real> {
          return {vertex[run.first + batch.a[l]], vertex[run.first + batch.b[l]], batch.rest[l],
                  shares ? shares[0] : run.equal_share, shares ? shares[kLanes] : run.equal_share};
        };
        const DistanceConstraint<Real> c = run.near ? link(run.near[n]) : link(run.far[n]);
        if (c.share_a != 0 || c.share_b != 0) constraints.push_back(c);
      }
  return constraints;
}

template <class Real>
std::size_t ColourBatches<Real>::bytes() const {
  return sizeof *this + near_.size() * sizeof near_[0] + far_.size() * sizeof far_[0] +
         extents_.size() * sizeof extents_[0] + damped_.size() * sizeof damped_[0] +
         (shares_.size() + multipliers_.size()) * sizeof(Real) + runs_.size() * sizeof runs_[0] +
         (tile_.size() + phase_.size()) * sizeof tile_[0];
}

template class ColourBatches<float>;
template class ColourBatches<double>;

}  // namespace taut
