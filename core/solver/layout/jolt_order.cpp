// Sorts links as Jolt Physics 5's soft body visits its edges after Optimize(), which Jolt requires.
// Batches of neighbouring vertices, made for Jolt's threads, come first, the one with most links
// first; within a batch, links nearest to a pin come first. Links between batches come last.
// Positions are floats, as in Jolt, so that ties are the same.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/model/adjacency.hpp"
#include "core/solver/layout/order.hpp"

namespace taut {

namespace {

constexpr std::size_t kBatch = 256;  ///< vertices
constexpr float kInfinity = std::numeric_limits<float>::infinity();

using FloatPoint = std::array<float, 3>;  ///< m

float distance2(const FloatPoint& a, const FloatPoint& b) {
  const float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return x * x + y * y + z * z;
}

class Batches {
 public:
  Batches(const std::vector<FloatPoint>& x, const Adjacency& neighbours)
      : x_(x), neighbours_(neighbours), batch_(x.size(), kNoVertex) {
    std::vector<int> own;
    for (int start; (start = farthest_out()) != kNoVertex;) {
      for (int next = start; next != kNoVertex && own.size() < kBatch; next = nearest(own)) {
        own.push_back(next);
        batch_[to_index(next)] = count_;
      }
      if (own.size() > kBatch / 2) {
        own.clear();
        ++count_;
      }  // otherwise the next start joins this batch
    }
  }

  /// The batch of a link, or count() if its ends are in different batches or in the incomplete one.
  int of(const Link& link) const {
    const int a = batch_[to_index(link.a)];
    return a == batch_[to_index(link.b)] ? a : count_;
  }
  int count() const { return count_; }

 private:
  static constexpr int kNoVertex = -1;

  /// The vertex without a batch that is lowest along their longest axis, then along the others.
  int farthest_out() const {
    FloatPoint low{kInfinity, kInfinity, kInfinity}, size{};
    for (std::size_t k = 0; k < 3; ++k) {
      float high = -kInfinity;
      for (std::size_t v = 0; v < x_.size(); ++v)
        if (batch_[v] == kNoVertex) {
          low[k] = std::min(low[k], x_[v][k]);
          high = std::max(high, x_[v][k]);
        }
      size[k] = high - low[k];
    }
    const std::size_t longest =
        size[0] > size[1] ? (size[2] > size[0] ? 2 : 0) : (size[2] > size[1] ? 2 : 1);
    std::size_t shortest =
        size[0] < size[1] ? (size[2] < size[0] ? 2 : 0) : (size[2] < size[1] ? 2 : 1);
    if (shortest == longest) shortest = (longest + 1) % 3;
    const auto along = [&](std::size_t v) {
      return std::tuple(x_[v][longest], x_[v][3 - longest - shortest], x_[v][shortest]);
    };
    int best = kNoVertex;
    for (std::size_t v = 0; v < x_.size(); ++v)
      if (batch_[v] == kNoVertex && (best == kNoVertex || along(v) < along(to_index(best))))
        best = static_cast<int>(v);
    return best;
  }

  /// The free neighbour of these vertices with the most links to them, then the nearest to their
  /// first.
  int nearest(const std::vector<int>& own) const {
    int best = kNoVertex;
    std::pair<std::ptrdiff_t, float> least{0, 0};  // minus the number of links, and distance
    for (const int vertex : own)
      for (const auto& [v, link] : neighbours_.of(vertex)) {
        if (batch_[to_index(v)] != kNoVertex) continue;
        const std::pair rank{-std::ranges::count_if(neighbours_.of(v),
                                                    [&](const Adjacency::End& end) {
                                                      return batch_[to_index(end.vertex)] == count_;
                                                    }),
                             distance2(x_[to_index(v)], x_[to_index(own.front())])};
        if (best == kNoVertex || rank < least) {
          best = v;
          least = rank;
        }
      }
    return best;
  }

  const std::vector<FloatPoint>& x_;
  const Adjacency& neighbours_;
  std::vector<int> batch_;
  int count_ = 0;
};

/// Distance [m] along links from the nearest pinned vertex; infinite without one.
std::vector<float> ways_to_pins(const Scene& scene, const std::vector<FloatPoint>& x,
                                const Adjacency& neighbours) {
  std::vector<int> pinned;
  const std::vector<double> w = inverse_masses(scene);
  for (std::size_t v = 0; v < x.size(); ++v)
    if (w[v] == 0) pinned.push_back(static_cast<int>(v));
  return shortest_ways(neighbours, pinned,
                       [&](int v, const Adjacency::End& end) {
                         return std::sqrt(distance2(x[to_index(end.vertex)], x[to_index(v)]));
                       })
      .length;
}

}  // namespace

std::vector<Link> jolt_order(const Scene& scene) {
  std::vector<FloatPoint> x;
  for (const Vec3& p : scene.start.x)
    x.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
  const Adjacency neighbours(scene.links, scene.mesh.size());
  const Batches batches(x, neighbours);
  const std::vector<float> way = ways_to_pins(scene, x, neighbours);
  std::vector<int> size(to_index(batches.count()) + 1);
  for (const Link& link : scene.links) --size[to_index(batches.of(link))];
  size.back() = 1;  // links between batches come last
  std::vector<Link> links = scene.links;
  std::ranges::stable_sort(links, {}, [&](const Link& link) {
    const int batch = batches.of(link);
    return std::tuple(size[to_index(batch)], batch,
                      std::min(way[to_index(link.a)], way[to_index(link.b)]),
                      std::min(link.a, link.b));
  });
  return links;
}

}  // namespace taut
