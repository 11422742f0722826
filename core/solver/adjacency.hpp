#pragma once

#include <algorithm>
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

}  // namespace taut
