#include "core/solver/layout/vertex_groups.hpp"

#include <algorithm>
#include <utility>

#include "core/model/index.hpp"

namespace taut {

namespace {

using Colours = std::vector<std::vector<int>>;

/// Greedy colouring, vertex after vertex: each takes the first colour that no neighbour has.
Colours colour_vertices(const Adjacency& ends, std::span<const BendingElement> bending,
                        std::span<const MembraneElement> membrane, std::span<const double> w) {
  std::vector<std::vector<const BendingElement*>> bent(bending.empty() ? 0 : w.size());
  for (const BendingElement& e : bending)
    for (std::size_t k = 0; k < e.size; ++k) bent[to_index(e.vertex[k])].push_back(&e);
  std::vector<std::vector<const MembraneElement*>> stretched(membrane.empty() ? 0 : w.size());
  for (const MembraneElement& e : membrane)
    for (const int v : e.vertex) stretched[to_index(v)].push_back(&e);
  std::vector<int> colour_of(w.size(), -1);
  Colours colours;
  for (std::size_t i = 0; i < w.size(); ++i) {
    if (w[i] == 0) continue;
    std::size_t colour = 0;
    const auto has = [&](int v) { return colour_of[to_index(v)] == static_cast<int>(colour); };
    const auto bends = [&](const BendingElement* e) {
      return std::any_of(e->vertex.begin(), e->vertex.begin() + static_cast<long>(e->size), has);
    };
    const auto stretches = [&](const MembraneElement* e) {
      return std::ranges::any_of(e->vertex, has);
    };
    const auto taken = [&] {
      return std::ranges::any_of(ends.of(static_cast<int>(i)), has, &Adjacency::End::vertex) ||
             (!bent.empty() && std::ranges::any_of(bent[i], bends)) ||
             (!stretched.empty() && std::ranges::any_of(stretched[i], stretches));
    };
    while (taken()) ++colour;
    colour_of[i] = static_cast<int>(colour);
    if (colour == colours.size()) colours.emplace_back();
    colours[colour].push_back(static_cast<int>(i));
  }
  return colours;
}

Colours one_by_one(std::span<const double> w) {
  Colours colours;
  for (std::size_t i = 0; i < w.size(); ++i)
    if (w[i] > 0) colours.push_back({static_cast<int>(i)});
  return colours;
}

/// Layout in which the colours follow one another, then the pins.
Layout side_by_side(const Colours& colours, std::span<const double> w) {
  std::vector<std::uint32_t> rank(w.size());
  std::uint32_t next = 0;
  for (const std::vector<int>& colour : colours)
    for (const int v : colour) rank[to_index(v)] = next++;
  for (std::size_t i = 0; i < w.size(); ++i)
    if (w[i] == 0) rank[i] = next++;
  return Layout::packed(w.size(), std::move(rank));
}

}  // namespace

VertexGroups::VertexGroups(const Adjacency& ends, std::span<const BendingElement> bending,
                           std::span<const MembraneElement> membrane, std::span<const double> w,
                           bool coloured) {
  const Colours colours = coloured ? colour_vertices(ends, bending, membrane, w) : one_by_one(w);
  layout_ = coloured ? side_by_side(colours, w) : Layout::packed(w.size());
  add_colours(colours, ends);
}

VertexGroups::VertexGroups(const Adjacency& ends, std::vector<int> order,
                           std::span<const double> w) {
  const Colours all{std::move(order)};
  layout_ = side_by_side(all, w);
  add_colours(all, ends);
}

void VertexGroups::add_colours(const std::vector<std::vector<int>>& colours,
                               const Adjacency& ends) {
  colour_.push_back(0);
  for (const std::span<const int> colour : colours) {
    for (std::size_t next = 0; next < colour.size(); next += kLanes)
      add_group(colour.subspan(next, std::min<std::size_t>(kLanes, colour.size() - next)), ends);
    colour_.push_back(groups_.size());
  }
}

void VertexGroups::add_group(std::span<const int> vertices, const Adjacency& ends) {
  VertexGroup group{};
  vertices_ += vertices.size();
  std::size_t slots = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const bool real = lane < vertices.size();
    vertex_.push_back(real ? vertices[lane] : -1);
    group.particle[lane] = real ? slot(to_index(vertices[lane])) : spare(lane);
    if (real) slots = std::max(slots, ends.of(vertices[lane]).size());
  }
  group.first_slot = groups_.empty() ? 0 : groups_.back().end_slot;
  group.end_slot = group.first_slot + static_cast<std::uint32_t>(slots);
  groups_.push_back(group);
}

std::size_t VertexGroups::bytes() const {
  return vertex_.size() * sizeof vertex_[0] + groups_.size() * sizeof groups_[0] +
         colour_.size() * sizeof colour_[0] + layout_.bytes();
}

}  // namespace taut
