#include "core/solver/layout/order.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <random>

#include "core/model/index.hpp"

namespace taut {

namespace {

constexpr int kTileSide = 32;                         ///< vertices on each side of a tile of a grid
constexpr int kTileVertices = kTileSide * kTileSide;  ///< 16 KiB of packed float positions

/// Cuts the vertices into halves across their longest side at rest until each part fits a tile.
void cut(std::span<int> vertices, const Mesh& mesh, int& next, std::vector<int>& tile) {
  const std::size_t tiles = (vertices.size() + kTileVertices - 1) / kTileVertices;
  if (tiles <= 1) {
    for (const int v : vertices) tile[to_index(v)] = next;
    ++next;
    return;
  }
  Eigen::AlignedBox3d box;
  for (const int v : vertices) box.extend(mesh.rest[to_index(v)]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::size_t half = vertices.size() * (tiles / 2) / tiles;
  const auto place = [&](int v) { return std::pair(mesh.rest[to_index(v)][axis], v); };
  std::ranges::nth_element(vertices, vertices.begin() + static_cast<std::ptrdiff_t>(half), {},
                           place);
  cut(vertices.first(half), mesh, next, tile);
  cut(vertices.subspan(half), mesh, next, tile);
}

/// Tile of each vertex: squares on a grid, neighbours at rest on any other mesh.
std::vector<int> tiles_of(const Mesh& mesh) {
  std::vector<int> tile(to_index(mesh.size()), -1);
  if (mesh.grid) {
    const int across = (mesh.grid->nu + kTileSide - 1) / kTileSide;
    for (int v = 0; v < mesh.size(); ++v)
      tile[to_index(v)] = v / mesh.grid->nu / kTileSide * across + v % mesh.grid->nu / kTileSide;
    return tile;
  }
  std::vector<int> vertices(tile.size());
  std::iota(vertices.begin(), vertices.end(), 0);
  int next = 0;
  cut(vertices, mesh, next, tile);
  return tile;
}

/// Greedy colouring: each colour takes every remaining link that shares no vertex with it.
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

/// Greedy grouping: each phase takes every remaining tile that shares no vertex with it.
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
      touches([&](int& p) {
        p = now;
        return false;
      });
      phase.push_back(std::move(tiles[t]));
      taken[t] = true;
      --left;
    }
  }
  return all;
}

}  // namespace

std::vector<Phase> colour(std::span<const Link> links, const Mesh& mesh) {
  const std::vector<int> tile_of = tiles_of(mesh);
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

std::vector<std::uint32_t> tile_ranks(const Mesh& mesh) {
  const std::vector<int> tile = tiles_of(mesh);
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
