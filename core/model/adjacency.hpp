#pragma once

#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/mesh.hpp"

namespace taut {

/// The links of each vertex, and their other ends.
class Adjacency {
 public:
  Adjacency(std::span<const Link> links, int vertices)
      : first_(to_index(vertices) + 1), ends_(2 * links.size()) {
    for (const Link& link : links) {
      ++first_[to_index(link.a) + 1];
      ++first_[to_index(link.b) + 1];
    }
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
  std::size_t size() const { return first_.size() - 1; }  ///< number of vertices
  std::span<const End> of(int v) const {
    return {ends_.data() + first_[to_index(v)], ends_.data() + first_[to_index(v) + 1]};
  }

 private:
  std::vector<int> first_;
  std::vector<End> ends_;
};

/// Shortest paths along links, for each vertex.
template <class Real>
struct ShortestPaths {
  std::vector<Real> length;  ///< m; infinite: not reachable
  std::vector<int> start;    ///< first vertex of the path; -1: not reachable
  std::vector<int> before;   ///< previous vertex on the path; -1: none
};

/// Shortest paths from the nearest of `starts` (Dijkstra). length_of(v, end): length of the link
/// from v to that end [m].
template <class LengthOf>
auto shortest_ways(const Adjacency& neighbours, std::span<const int> starts,
                   const LengthOf& length_of) {
  using Real = decltype(length_of(0, Adjacency::End{}));
  ShortestPaths<Real> paths;
  paths.length.resize(neighbours.size(), std::numeric_limits<Real>::infinity());
  paths.start.resize(neighbours.size(), -1);
  paths.before = paths.start;
  using Reached = std::pair<Real, int>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
  const auto reach = [&](int v, Real length, int start, int before) {
    if (!(length < paths.length[to_index(v)])) return;
    paths.length[to_index(v)] = length;
    paths.start[to_index(v)] = start;
    paths.before[to_index(v)] = before;
    open.emplace(length, v);
  };
  for (const int v : starts) reach(v, 0, v, -1);
  while (!open.empty()) {
    const auto [length, v] = open.top();
    open.pop();
    if (length > paths.length[to_index(v)]) continue;
    for (const Adjacency::End& end : neighbours.of(v))
      reach(end.vertex, length + length_of(v, end), paths.start[to_index(v)], v);
  }
  return paths;
}

}  // namespace taut
