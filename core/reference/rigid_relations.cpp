#include "core/reference/rigid_relations.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/model/index.hpp"

namespace taut::reference {

namespace {

constexpr double kFlat = 1e-13;     ///< deviation from a plane or a line, as a share of lengths
constexpr double kNothing = 1e-12;  ///< a weight that counts as 0 beside those of order 1

/// Weights with sum of weights x = 0 for three vertices at these distances; empty if they are not
/// on a line.
std::vector<double> on_a_line(double ab, double ac, double bc) {
  for (const auto& [sum, relation] :
       {std::pair(ab + bc - ac, std::vector{-bc / ac, 1.0, -ab / ac}),
        std::pair(ab + ac - bc, std::vector{1.0, -ac / bc, -ab / bc}),
        std::pair(ac + bc - ab, std::vector{-bc / ab, -ac / ab, 1.0})})
    if (std::abs(sum) < kFlat * (ab + ac + bc)) return relation;
  return {};
}

/// Weights as in on_a_line() for four vertices in a plane, with a, b and c not on a line; empty if
/// they are not in a plane.
std::vector<double> in_a_plane(double ab, double ac, double ad, double bc, double bd, double cd) {
  const auto place = [&](double from_a, double from_b) {  // a = (0, 0), b = (ab, 0)
    const double along = (ab * ab + from_a * from_a - from_b * from_b) / (2 * ab);
    return std::pair(along, std::sqrt(std::max(0.0, from_a * from_a - along * along)));
  };
  const auto [cx, cy] = place(ac, bc);
  const auto [dx, up] = place(ad, bd);
  for (const double dy : {up, -up})
    if (std::abs(std::hypot(dx - cx, dy - cy) - cd) < kFlat * (ab + ac + ad)) {
      const double c = dy / cy, b = (dx - c * cx) / ab;
      return {1 - b - c, b, c, -1};
    }
  return {};
}

}  // namespace

std::vector<Weights> rigid_relations(const Scene& scene, const Stiffness& stiffness,
                                     const std::vector<double>& inertia) {
  const std::size_t n = inertia.size();
  std::vector<Weights> beside(n);    // distances to later neighbours
  for (const Link& l : scene.links)  // also between pins
    if (std::isinf(stiffness[static_cast<std::size_t>(l.family)]))
      beside[to_index(std::min(l.a, l.b))][to_index(std::max(l.a, l.b))] = l.rest;
  std::vector<Weights> of_others(n);
  for (std::size_t i = 0; i < n; ++i) of_others[i][i] = 1;
  bool any = false;
  const auto take = [&](const std::vector<std::size_t>& vertices, const std::vector<double>& c) {
    Weights sum;
    for (std::size_t k = 0; k < c.size(); ++k)
      for (const auto& [v, weight] : of_others[vertices[k]]) sum[v] += c[k] * weight;
    std::size_t solved = n;
    for (const auto& [v, weight] : sum)
      if (inertia[v] > 0 && std::abs(weight) > kNothing &&
          (solved == n || std::abs(weight) >= (1 - kNothing) * std::abs(sum[solved])))
        solved = v;
    if (solved == n) return;  // the other relations imply it
    any = true;
    const double own = sum[solved];
    sum.erase(solved);
    for (Weights& one : of_others)
      if (const auto at = one.find(solved); at != one.end()) {
        const double share = at->second / own;
        one.erase(at);
        for (const auto& [v, weight] : sum)
          if (std::abs(one[v] -= share * weight) < kNothing) one.erase(v);
      }
  };
  for (std::size_t a = 0; a < n; ++a)
    for (const auto& [b, ab] : beside[a])
      for (const auto& [c, bc] : beside[b]) {
        const auto ac = beside[a].find(c);
        if (ac == beside[a].end()) continue;
        if (const auto line = on_a_line(ab, ac->second, bc); !line.empty()) {
          take({a, b, c}, line);
          continue;
        }
        for (const auto& [d, cd] : beside[c]) {
          const auto ad = beside[a].find(d), bd = beside[b].find(d);
          if (ad == beside[a].end() || bd == beside[b].end()) continue;
          take({a, b, c, d}, in_a_plane(ab, ac->second, ad->second, bc, bd->second, cd));
        }
      }
  if (!any) return {};
  return of_others;
}

}  // namespace taut::reference
