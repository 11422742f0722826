#include "core/solver/constraints/tethers.hpp"

#include <algorithm>
#include <limits>
#include <queue>

#include "core/model/index.hpp"
#include "core/solver/layout/order.hpp"

namespace taut {

namespace {

constexpr int kMostGroups = 4;

/// Pins that links join, group by group.
std::vector<std::vector<int>> pin_groups(const Scene& scene, const Adjacency& neighbours) {
  std::vector<bool> open(to_index(scene.mesh.size()));
  for (const int pin : scene.pins) open[to_index(pin)] = true;
  std::vector<std::vector<int>> groups;
  for (const int start : scene.pins) {
    if (!open[to_index(start)]) continue;
    std::vector<int>& group = groups.emplace_back();
    group.push_back(start), open[to_index(start)] = false;
    for (std::size_t i = 0; i < group.size(); ++i)
      for (const auto& [v, link] : neighbours.of(group[i]))
        if (open[to_index(v)]) open[to_index(v)] = false, group.push_back(v);
  }
  return groups;
}

struct Way {
  double length = std::numeric_limits<double>::infinity();
  int pin = -1;
};

/// The shortest way along the links from any pin of the group to every vertex (Dijkstra).
std::vector<Way> ways(const std::vector<int>& group, std::span<const Link> links,
                      const Adjacency& neighbours, int vertices) {
  std::vector<Way> way(to_index(vertices));
  using Item = std::pair<double, int>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> open;
  for (const int pin : group) way[to_index(pin)] = {0, pin}, open.push({0, pin});
  while (!open.empty()) {
    const auto [length, v] = open.top();
    open.pop();
    if (length > way[to_index(v)].length) continue;
    for (const auto& [to, link] : neighbours.of(v))
      if (const double there = length + links[to_index(link)].rest;
          there < way[to_index(to)].length) {
        way[to_index(to)] = {there, way[to_index(v)].pin};
        open.push({there, to});
      }
  }
  return way;
}

}  // namespace

std::vector<Tether> make_tethers(const Scene& scene) {
  std::vector<Link> links = scene.links;
  std::erase_if(links, [](const Link& l) { return l.family == Family::bend; });
  const bool straight = keeps_flat_distances(scene);
  const Adjacency neighbours(links, scene.mesh.size());
  std::vector<std::vector<Tether>> candidates(to_index(scene.mesh.size()));
  for (const auto& group : pin_groups(scene, neighbours)) {
    const std::vector<Way> way = ways(group, links, neighbours, scene.mesh.size());
    for (int v = 0; v < scene.mesh.size(); ++v) {
      const auto& [length, pin] = way[to_index(v)];
      if (pin < 0 || std::binary_search(scene.pins.begin(), scene.pins.end(), v)) continue;
      const Vec3 line = scene.mesh.rest[to_index(v)] - scene.mesh.rest[to_index(pin)];
      candidates[to_index(v)].push_back({v, pin, straight ? line.norm() : length});
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
