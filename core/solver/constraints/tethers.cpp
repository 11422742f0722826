#include "core/solver/constraints/tethers.hpp"

#include <algorithm>

#include "core/model/adjacency.hpp"
#include "core/solver/layout/order.hpp"

namespace taut {

namespace {

/// Most tethers of one vertex, each to another group of pins.
constexpr int kMostGroups = 4;

/// Pins in groups; links between pins put them in one group.
std::vector<std::vector<int>> pin_groups(const Scene& scene, const Adjacency& neighbours) {
  std::vector<bool> open(to_index(scene.mesh.size()));
  for (const int pin : scene.pins) open[to_index(pin)] = true;
  std::vector<std::vector<int>> groups;
  for (const int start : scene.pins) {
    if (!open[to_index(start)]) continue;
    std::vector<int>& group = groups.emplace_back();
    group.push_back(start);
    open[to_index(start)] = false;
    for (std::size_t i = 0; i < group.size(); ++i)
      for (const auto& [v, link] : neighbours.of(group[i]))
        if (open[to_index(v)]) {
          open[to_index(v)] = false;
          group.push_back(v);
        }
  }
  return groups;
}

}  // namespace

std::vector<Tether> make_tethers(const Scene& scene) {
  std::vector<Link> links = scene.links;
  std::erase_if(links, [](const Link& l) { return l.family == Family::bend; });
  const bool straight = keeps_flat_distances(scene);
  const Adjacency neighbours(links, scene.mesh.size());
  std::vector<std::vector<Tether>> candidates(to_index(scene.mesh.size()));
  for (const auto& group : pin_groups(scene, neighbours)) {
    const auto ways = shortest_ways(neighbours, group, [&](int, const Adjacency::End& end) {
      return links[to_index(end.link)].rest;
    });
    for (int v = 0; v < scene.mesh.size(); ++v) {
      const int pin = ways.start[to_index(v)];
      if (pin < 0 || std::binary_search(scene.pins.begin(), scene.pins.end(), v)) continue;
      const Vec3 line = scene.mesh.rest[to_index(v)] - scene.mesh.rest[to_index(pin)];
      candidates[to_index(v)].push_back(
          {v, pin, straight ? line.norm() : ways.length[to_index(v)]});
    }
  }
  std::vector<Tether> tethers;
  for (auto& list : candidates) {
    std::stable_sort(list.begin(), list.end(),
                     [](const Tether& a, const Tether& b) { return a.length < b.length; });
    if (list.size() > kMostGroups) list.resize(kMostGroups);
    tethers.insert(tethers.end(), list.begin(), list.end());
  }
  return tethers;
}

}  // namespace taut
