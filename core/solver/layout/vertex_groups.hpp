#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/model/adjacency.hpp"
#include "core/model/bending.hpp"
#include "core/model/membrane.hpp"
#include "core/solver/layout/particles.hpp"
#include "core/solver/simd/kernels.hpp"

namespace taut {

/// The vertices that move, divided for sweeps that move one vertex at a time while all others are
/// held. If coloured, no two vertices of a colour are linked, in one bending element or in one
/// triangle of a membrane. Colours are divided into groups of kLanes, whatever lanes the machine
/// has, and the particles of a group lie side by side.
class VertexGroups {
 public:
  VertexGroups() = default;
  /// w: inverse masses [1/kg], 0: pinned. If not coloured, each vertex is a colour of its own, in
  /// the given order.
  VertexGroups(const Adjacency&, std::span<const BendingElement>, std::span<const MembraneElement>,
               std::span<const double> w, bool coloured);
  /// One colour of all vertices that move, in this order, for sweeps that only read positions.
  VertexGroups(const Adjacency&, std::vector<int> order, std::span<const double> w);

  const Layout& layout() const { return layout_; }
  std::size_t colours() const { return colour_.size() - 1; }
  /// First group of a colour; first_group(colours()) is the number of groups.
  std::size_t first_group(std::size_t colour) const { return colour_[colour]; }
  std::size_t size() const { return groups_.size(); }
  std::size_t vertices() const { return vertices_; }
  const VertexGroup* data() const { return groups_.data(); }
  /// The vertex in a lane of a group; -1: none.
  int vertex(std::size_t group, std::size_t lane) const { return vertex_[group * kLanes + lane]; }

  /// Makes the slots: every link has one at each end that moves. Calls set(slot, lane, link) for
  /// the links of every vertex in their order.
  template <class Slot, class Set>
  std::vector<Slot> make_slots(const Adjacency& ends, const Set& set) const {
    std::vector<Slot> slots(groups_.empty() ? 0 : groups_.back().end_slot);
    for (std::size_t g = 0; g < groups_.size(); ++g)
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const VertexGroup& group = groups_[g];
        for (std::size_t s = group.first_slot; s < group.end_slot; ++s)
          slots[s].other[lane] = group.particle[lane];
        if (vertex(g, lane) < 0) continue;
        std::size_t s = group.first_slot;
        for (const Adjacency::End& end : ends.of(vertex(g, lane))) {
          slots[s].other[lane] = slot(to_index(end.vertex));
          set(slots[s++], lane, to_index(end.link));
        }
      }
    return slots;
  }
  std::size_t bytes() const;

 private:
  PackedSlot slot(std::size_t vertex) const {
    return {static_cast<std::uint32_t>(layout_.slot(vertex))};
  }
  PackedSlot spare(std::size_t lane) const {
    return {static_cast<std::uint32_t>(4 * (layout_.size() + lane))};
  }
  void add_colours(const std::vector<std::vector<int>>& colours, const Adjacency&);
  void add_group(std::span<const int> vertices, const Adjacency&);
  std::vector<int> vertex_;  ///< [groups][kLanes]
  std::size_t vertices_ = 0;
  std::vector<VertexGroup> groups_;
  std::vector<std::size_t> colour_;  ///< first group of each colour, and the end
  Layout layout_;
};

}  // namespace taut
