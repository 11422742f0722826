#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/model/mesh.hpp"

namespace taut {

/// In which order Gauss-Seidel visits the links. It decides convergence, stability under substeps
/// and what can run in parallel; core/README.md has the comparison.
enum class Order {
  mesh,      ///< as the scene lists them
  coloured,  ///< independent groups, tile by tile
  reversed,  ///< the scene's list backwards
  random     ///< shuffled once, by seed
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
std::vector<std::uint32_t> tile_ranks(std::span<const Link>, const Mesh&);

/// All links, one after the other.
std::vector<Link> flatten(const std::vector<Phase>&);

/// The links in the given order; seed is for Order::random.
std::vector<Link> ordered(std::span<const Link>, const Mesh&, Order, std::uint32_t seed);

}  // namespace taut
