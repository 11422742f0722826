#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/scene.hpp"

namespace taut {

/// The other ends of each vertex's links, and which links those are.
class Adjacency {
 public:
  Adjacency(std::span<const Link> links, int vertices)
      : first_(to_index(vertices) + 1), ends_(2 * links.size()) {
    for (const Link& link : links) ++first_[to_index(link.a) + 1], ++first_[to_index(link.b) + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (int l = 0; l < static_cast<int>(links.size()); ++l) {
      const Link& link = links[to_index(l)];
      ends_[to_index(next[to_index(link.a)]++)] = {link.b, l};
      ends_[to_index(next[to_index(link.b)]++)] = {link.a, l};
    }
  }

  struct End {
    int vertex, link;
  };
  std::span<const End> of(int v) const {
    return {ends_.data() + first_[to_index(v)], ends_.data() + first_[to_index(v) + 1]};
  }

 private:
  std::vector<int> first_;
  std::vector<End> ends_;
};

/// Whether no two vertices can be farther apart than they are in the flat sheet: a regular sheet
/// with shear links. One without is a net: pulled along its diagonals it grows longer, up to the
/// way along its links.
inline bool keeps_flat_distances(const Scene& scene) {
  return scene.mesh.grid && std::any_of(scene.links.begin(), scene.links.end(),
                                        [](const Link& l) { return l.family == Family::shear; });
}

/// In which order Gauss-Seidel visits the links. It decides convergence, stability under substeps
/// and what can run in parallel; results/benchmarks/default-setting.md compares.
enum class Order {
  mesh,      ///< as the scene lists them
  coloured,  ///< independent groups, tile by tile
  reversed,  ///< the scene's list backwards
  random,    ///< shuffled once, by seed
  jolt       ///< as Jolt Physics' soft body sorts its edges
};

/// Links that share no vertex, so that their order among themselves does not matter.
using Colour = std::vector<Link>;
/// A neighbourhood small enough for the first-level cache: its colours, one after the other.
using Tile = std::vector<Colour>;
/// Tiles that share no vertex: they may run at the same time.
using Phase = std::vector<Tile>;

/// Sorts links into phases of tiles of colours, family after family within a tile. Depends only on
/// the links and the mesh.
std::vector<Phase> colour(std::span<const Link>, const Mesh&);

/// Places of the vertices in memory such that those of a tile are neighbours.
std::vector<std::uint32_t> tile_ranks(const Mesh&);

/// All links, one after the other.
std::vector<Link> flatten(const std::vector<Phase>&);

/// As Jolt Physics 5.3 to 5.5 sorts a soft body's edges that start at scene.start (Optimize()).
std::vector<Link> jolt_order(const Scene&);

/// The scene's links in the given order; seed is for Order::random.
std::vector<Link> ordered(const Scene&, Order, std::uint32_t seed);

}  // namespace taut
