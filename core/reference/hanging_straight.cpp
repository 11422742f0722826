#include "core/reference/hanging_straight.hpp"

#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "core/model/index.hpp"

namespace taut::reference {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 1e-9;

struct Paths {
  std::vector<double> length;  ///< [n] m from the source
  std::vector<int> before;     ///< [n] the vertex before; -1 at the source
};

using Neighbours = std::vector<std::vector<std::pair<int, double>>>;

/// Dijkstra over the links.
Paths shortest_paths(const Neighbours& next, int source) {
  Paths p{std::vector<double>(next.size(), kFar), std::vector<int>(next.size(), -1)};
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  p.length[to_index(source)] = 0;
  open.emplace(0.0, source);
  while (!open.empty()) {
    const auto [d, i] = open.top();
    open.pop();
    if (d > p.length[to_index(i)]) continue;
    for (const auto& [j, l] : next[to_index(i)])
      if (d + l < p.length[to_index(j)]) {
        p.length[to_index(j)] = d + l;
        p.before[to_index(j)] = i;
        open.emplace(d + l, j);
      }
  }
  return p;
}

}  // namespace

std::optional<std::vector<Vec3>> hanging_straight(const Scene& scene) {
  const std::size_t n = scene.start.x.size();
  Neighbours next(n);
  for (const Link& l : scene.links) {
    next[to_index(l.a)].emplace_back(l.b, l.rest);
    next[to_index(l.b)].emplace_back(l.a, l.rest);
  }
  std::vector<Vec3> x = scene.start.x;
  std::vector<bool> fixed(n, false);
  std::vector<Paths> from;
  for (const int pin : scene.pins) fixed[to_index(pin)] = true;
  for (const int pin : scene.pins) from.push_back(shortest_paths(next, pin));
  for (std::size_t p = 0; p < scene.pins.size(); ++p)
    for (std::size_t q = 0; q < p; ++q) {
      const int a = scene.pins[p], b = scene.pins[q];
      const double length = from[p].length[to_index(b)];
      const Vec3 along = (x[to_index(b)] - x[to_index(a)]) / length;
      if (!(along.norm() > 1 - kTolerance)) continue;
      for (int i = b; i >= 0 && i != a; i = from[p].before[to_index(i)])
        if (!fixed[to_index(i)]) {
          fixed[to_index(i)] = true;
          x[to_index(i)] = x[to_index(a)] + from[p].length[to_index(i)] * along;
        }
    }
  // A vertex is at its lowest when, over all fixed ones, height - path length is largest.
  const Vec3 down = scene.gravity.normalized();
  std::vector<double> lowest(n, kFar);
  std::vector<Vec3> place = x;
  for (std::size_t f = 0; f < n; ++f) {
    if (!fixed[f]) continue;
    const Paths paths = shortest_paths(next, static_cast<int>(f));
    for (std::size_t i = 0; i < n; ++i) {
      const double depth = down.dot(x[f]) + paths.length[i];
      if (fixed[i] || !(depth < lowest[i])) continue;
      lowest[i] = depth;
      place[i] = x[f] + paths.length[i] * down;
    }
  }
  for (const Link& l : scene.links)
    if (!(std::abs((place[to_index(l.b)] - place[to_index(l.a)]).norm() - l.rest) <
          kTolerance * l.rest))
      return {};
  for (std::size_t i = 0; i < n; ++i)
    if (!fixed[i] && lowest[i] == kFar) return {};
  return place;
}

}  // namespace taut::reference
