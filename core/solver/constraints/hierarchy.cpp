#include "core/solver/constraints/hierarchy.hpp"

#include <algorithm>
#include <map>

#include "core/model/adjacency.hpp"
#include "core/solver/layout/order.hpp"

namespace taut {

namespace {

/// Coarse vertices: the pins and a greedy independent set in the order of the vertices.
std::vector<bool> choose(const std::vector<int>& vertices, const Adjacency& neighbours,
                         std::span<const double> w) {
  std::vector<bool> coarse(w.size());
  for (const int v : vertices) coarse[to_index(v)] = w[to_index(v)] == 0;
  for (const int v : vertices) {
    const auto near = neighbours.of(v);
    if (std::none_of(near.begin(), near.end(), [&](const auto& end) {
          return coarse[to_index(end.vertex)] && w[to_index(end.vertex)] > 0;
        }))
      coarse[to_index(v)] = true;
  }
  return coarse;
}

/// Links between coarse vertices that are linked or share a finer neighbour. On a sheet that keeps
/// flat distances the rest length is the straight distance; elsewhere it is the length of the path
/// through the neighbour, which a fold can only shorten.
std::vector<Link> coarse_links(const Scene& scene, std::span<const Link> links,
                               const Adjacency& neighbours, const std::vector<bool>& coarse,
                               const std::vector<int>& vertices) {
  const std::vector<Vec3>& flat = scene.mesh.rest;
  const bool straight = keeps_flat_distances(scene);
  std::map<std::pair<int, int>, double> rest;
  const auto offer = [&](int a, int b, double length) {
    if (a == b) return;
    if (straight) length = (flat[to_index(a)] - flat[to_index(b)]).norm();
    const auto [place, is_new] = rest.try_emplace(std::minmax(a, b), length);
    place->second = std::min(place->second, length);
  };
  for (const int v : vertices) {
    const auto near = neighbours.of(v);
    for (const auto& [a, to_a] : near) {
      if (!coarse[to_index(a)]) continue;
      if (coarse[to_index(v)]) offer(v, a, links[to_index(to_a)].rest);
      if (coarse[to_index(v)]) continue;
      for (const auto& [b, to_b] : near)
        if (coarse[to_index(b)] && a < b)
          offer(a, b, links[to_index(to_a)].rest + links[to_index(to_b)].rest);
    }
  }
  std::vector<Link> result;
  for (const auto& [ends, length] : rest)
    result.push_back({ends.first, ends.second, length, Family::structural});
  return result;
}

}  // namespace

std::vector<Level> make_hierarchy(const Scene& scene, std::span<const double> w, int levels) {
  std::vector<Link> links = scene.links;
  std::erase_if(links, [](const Link& l) { return l.family != Family::structural; });
  std::vector<int> vertices(to_index(scene.mesh.size()));
  for (int v = 0; v < scene.mesh.size(); ++v) vertices[to_index(v)] = v;
  std::vector<Level> hierarchy;
  while (static_cast<int>(hierarchy.size()) < levels) {
    const Adjacency neighbours(links, scene.mesh.size());
    const std::vector<bool> coarse = choose(vertices, neighbours, w);
    Level level;
    for (const int v : vertices) {
      if (coarse[to_index(v)]) {
        level.vertices.push_back(v);
        continue;
      }
      Level::Child child{v, static_cast<int>(level.parents.size()), 0};
      double sum = 0;
      for (const auto& [p, link] : neighbours.of(v))
        if (coarse[to_index(p)] && links[to_index(link)].rest > 0) {
          level.parents.push_back({p, 1 / links[to_index(link)].rest});
          sum += level.parents.back().weight;
        }
      child.end = static_cast<int>(level.parents.size());
      for (int p = child.first; p < child.end; ++p) level.parents[to_index(p)].weight /= sum;
      if (child.end > child.first) level.children.push_back(child);
    }
    if (level.vertices.size() == vertices.size()) break;
    links = coarse_links(scene, links, neighbours, coarse, vertices);
    level.links = make_distance_constraints<double>(links, w, 1);
    level.vertices.shrink_to_fit();
    level.parents.shrink_to_fit();
    level.children.shrink_to_fit();
    vertices = level.vertices;
    hierarchy.insert(hierarchy.begin(), std::move(level));
  }
  return hierarchy;
}

}  // namespace taut
