#pragma once

#include <vector>

#include "core/model/scene.hpp"
#include "core/solver/stick.hpp"

namespace taut {

/// One level of a hierarchy of coarser and coarser cloths.
struct Level {
  std::vector<int> vertices;         ///< of this level; about half of the finer one's
  std::vector<Stick<double>> links;  ///< between vertices that were two links apart
  /// A vertex of the next finer level only: it moves with the weighted mean of `parents`.
  struct Child {
    int vertex = 0;
    int first = 0, end = 0;  ///< in `parents`
  };
  std::vector<Child> children;
  struct Parent {
    int vertex = 0;
    double weight = 0;  ///< inverse distance at rest; those of a child add up to 1
  };
  std::vector<Parent> parents;
};

/// Mueller, Hierarchical Position Based Dynamics (VRIPHYS 2008): each level takes every pin and a
/// greedy independent set of the finer level, so that every other vertex has a neighbour in it.
/// The first is the coarsest. At most `levels`; fewer when nothing is left to make coarser.
std::vector<Level> make_hierarchy(const Scene&, std::span<const double> w, int levels);

}  // namespace taut
