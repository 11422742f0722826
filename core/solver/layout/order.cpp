#include "core/solver/layout/order.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <random>

namespace taut {

namespace {

constexpr int kTileSide = 32;                         ///< grid vertices
constexpr int kTileVertices = kTileSide * kTileSide;  ///< 16 KiB of packed float positions

/// Tile of each vertex: squares of a grid; runs of a breadth-first walk on any other mesh.
std::vector<int> tiles_of(std::span<const Link> links, const Mesh& mesh) {
  std::vector<int> tile(to_index(mesh.size()), -1);
  if (mesh.grid) {
    const int across = (mesh.grid->nu + kTileSide - 1) / kTileSide;
    for (int v = 0; v < mesh.size(); ++v)
      tile[to_index(v)] = v / mesh.grid->nu / kTileSide * across + v % mesh.grid->nu / kTileSide;
    return tile;
  }
  const Adjacency neighbours(links, mesh.size());
  std::vector<int> queue;
  queue.reserve(tile.size());
  for (int start = 0, next = 0; start < mesh.size(); ++start) {
    if (tile[to_index(start)] >= 0) continue;
    tile[to_index(start)] = static_cast<int>(queue.size()) / kTileVertices;
    queue.push_back(start);
    for (; next < static_cast<int>(queue.size()); ++next)
      for (const auto& [v, link] : neighbours.of(queue[to_index(next)]))
        if (tile[to_index(v)] < 0) {
          tile[to_index(v)] = static_cast<int>(queue.size()) / kTileVertices;
          queue.push_back(v);
        }
  }
  return tile;
}

/// Greedy: each colour takes every remaining link that touches none of its vertices.
void colour_family(std::vector<Link> links, std::vector<int>& stamp, int& now, Tile& tile) {
  while (!links.empty()) {
    ++now;
    Colour colour;
    std::erase_if(links, [&](const Link& link) {
      int &a = stamp[to_index(link.a)], &b = stamp[to_index(link.b)];
      if (a == now || b == now) return false;
      a = b = now;
      colour.push_back(link);
      return true;
    });
    tile.push_back(std::move(colour));
  }
}

/// Greedy too: each phase takes every remaining tile that touches none of its vertices.
std::vector<Phase> phases(std::vector<Tile> tiles, std::size_t vertices) {
  std::vector<Phase> all;
  std::vector<int> phase_of_vertex(vertices, -1);
  std::vector<bool> taken(tiles.size());
  for (std::size_t left = tiles.size(); left > 0;) {
    const int now = static_cast<int>(all.size());
    Phase& phase = all.emplace_back();
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      if (taken[t]) continue;
      const auto touches = [&](const auto& does) {
        for (const Colour& c : tiles[t])
          for (const Link& link : c)
            if (does(phase_of_vertex[to_index(link.a)]) || does(phase_of_vertex[to_index(link.b)]))
              return true;
        return false;
      };
      if (touches([&](int p) { return p == now; })) continue;
      touches([&](int& p) { return p = now, false; });
      phase.push_back(std::move(tiles[t]));
      taken[t] = true, --left;
    }
  }
  return all;
}

}  // namespace

std::vector<Phase> colour(std::span<const Link> links, const Mesh& mesh) {
  const std::vector<int> tile_of = tiles_of(links, mesh);
  const int count = mesh.size() == 0 ? 0 : *std::max_element(tile_of.begin(), tile_of.end()) + 1;
  std::vector<std::array<std::vector<Link>, kFamilies.size()>> sorted(to_index(count));
  for (const Link& link : links)
    sorted[to_index(tile_of[to_index(link.a)])][static_cast<std::size_t>(link.family)].push_back(
        link);
  std::vector<int> stamp(to_index(mesh.size()), 0);
  int now = 0;
  std::vector<Tile> tiles;
  for (auto& families : sorted) {
    Tile tile;
    for (auto& family : families) colour_family(std::move(family), stamp, now, tile);
    if (!tile.empty()) tiles.push_back(std::move(tile));
  }
  return phases(std::move(tiles), to_index(mesh.size()));
}

std::vector<std::uint32_t> tile_ranks(std::span<const Link> links, const Mesh& mesh) {
  const std::vector<int> tile = tiles_of(links, mesh);
  std::vector<std::uint32_t> sorted(tile.size()), rank(tile.size());
  std::iota(sorted.begin(), sorted.end(), 0u);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return tile[a] < tile[b]; });
  for (std::uint32_t place = 0; place < sorted.size(); ++place) rank[sorted[place]] = place;
  return rank;
}

std::vector<Link> flatten(const std::vector<Phase>& phases) {
  std::vector<Link> links;
  for (const Phase& phase : phases)
    for (const Tile& tile : phase)
      for (const Colour& colour : tile) links.insert(links.end(), colour.begin(), colour.end());
  return links;
}

std::vector<Link> ordered(const Scene& scene, Order order, std::uint32_t seed) {
  if (order == Order::coloured) return flatten(colour(scene.links, scene.mesh));
  if (order == Order::jolt) return jolt_order(scene);
  std::vector<Link> list = scene.links;
  if (order == Order::reversed) std::reverse(list.begin(), list.end());
  if (order == Order::random) {
    // Fisher-Yates by hand: std::shuffle differs between standard libraries
    std::mt19937 random(seed);
    for (std::size_t i = list.size(); i > 1; --i) std::swap(list[i - 1], list[random() % i]);
  }
  return list;
}

}  // namespace taut
