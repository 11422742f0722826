#pragma once

#include <algorithm>
#include <vector>

#include "core/solver/distance.hpp"
#include "core/solver/pass.hpp"
#include "core/solver/stick.hpp"

namespace taut {

/// A cost line for each family that has links; their memory is shared out evenly.
inline std::vector<PassCost> family_costs(std::span<const Link> links, std::span<const double> w,
                                          std::size_t bytes) {
  std::array<std::size_t, kFamilies.size()> items{};
  std::size_t all = 0;
  for (const Link& link : links)
    if (moves(link, w)) ++items[static_cast<std::size_t>(link.family)], ++all;
  std::vector<PassCost> costs;
  for (const Family family : kFamilies)
    if (const std::size_t n = items[static_cast<std::size_t>(family)]; n > 0)
      costs.push_back({.pass = std::string(to_string(family)),
                       .items = n,
                       .bytes = bytes * n / all,
                       .projections = true});
  return costs;
}

/// One Gauss-Seidel sweep over the links, one after the other.
template <class Real, Projection kind>
class LinkPass final : public Pass<Real> {
 public:
  LinkPass(std::vector<Stick<Real>> sticks, std::vector<PassCost> costs)
      : sticks_(std::move(sticks)), costs_(std::move(costs)) {}

  void apply(Particles<Real>& p, double, double) override {
    Real* const x = p.x.data();
    for (const Stick<Real>& stick : sticks_) {
      Real* const a = x + 4 * stick.a;
      Real* const b = x + 4 * stick.b;
      Triple<Real> x1{a[0], a[1], a[2]}, x2{b[0], b[1], b[2]};
      project_distance<kind>(x1, x2, stick.rest, stick.share_a, stick.share_b);
      a[0] = x1.x, a[1] = x1.y, a[2] = x1.z;
      b[0] = x2.x, b[1] = x2.y, b[2] = x2.z;
    }
  }

  std::vector<PassCost> cost() const override { return costs_; }

 private:
  std::vector<Stick<Real>> sticks_;
  std::vector<PassCost> costs_;
};

}  // namespace taut
