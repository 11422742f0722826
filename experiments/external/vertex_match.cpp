#include "experiments/external/vertex_match.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

namespace taut::external {

namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

std::string coordinates(const Vec3& x) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, "(%.6g, %.6g, %.6g)", x.x(), x.y(), x.z());
  return buffer;
}

/// The nearest vertex of `all` and its distance [m].
std::pair<std::size_t, double> nearest(const Vec3& x, const std::vector<Vec3>& all) {
  std::pair<std::size_t, double> best{kNone, std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < all.size(); ++i)
    if (const double d = (all[i] - x).norm(); d < best.second) best = {i, d};
  return best;
}

/// Vertices in the order of their x.
class Neighbours {
 public:
  explicit Neighbours(const std::vector<Vec3>& all) : all_(all), order_(all.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::ranges::sort(order_, {}, [&](std::size_t i) { return all_[i].x(); });
  }

  /// The nearest within `radius`; kNone: there is none.
  std::size_t within(const Vec3& x, double radius) const {
    std::size_t best = kNone;
    auto at = std::ranges::lower_bound(order_, x.x() - radius, {},
                                       [&](std::size_t i) { return all_[i].x(); });
    for (; at != order_.end() && all_[*at].x() <= x.x() + radius; ++at)
      if (const double d = (all_[*at] - x).norm(); d <= radius) radius = d, best = *at;
    return best;
  }

 private:
  const std::vector<Vec3>& all_;
  std::vector<std::size_t> order_;
};

}  // namespace

bool VertexMatch::same_order() const { return std::ranges::is_sorted(of_scene); }

VertexMatch match_vertices(const std::vector<Vec3>& file, const std::vector<Vec3>& scene,
                           double tolerance) {
  VertexMatch match;
  if (file.size() != scene.size()) {
    match.mismatch = "it has " + std::to_string(file.size()) + " vertices, the scene has " +
                     std::to_string(scene.size());
    return match;
  }
  for (std::size_t i = 0; i < file.size(); ++i)
    if (!file[i].allFinite()) {
      match.mismatch = "its vertex " + std::to_string(i) + " begins at " + coordinates(file[i]);
      return match;
    }
  match.of_scene.resize(file.size());
  std::iota(match.of_scene.begin(), match.of_scene.end(), std::size_t{0});
  const auto farthest = [&] {
    double d = 0;
    for (std::size_t i = 0; i < scene.size(); ++i)
      d = std::max(d, (file[match.of_scene[i]] - scene[i]).norm());
    return d;
  };
  match.farthest = farthest();
  if (match.farthest <= tolerance) return match;

  match.of_scene.assign(file.size(), kNone);
  const Neighbours neighbours(scene);
  std::size_t strays = 0, first_stray = kNone;
  for (std::size_t i = 0; i < file.size(); ++i) {
    const std::size_t same = neighbours.within(file[i], tolerance);
    if (same == kNone) {
      ++strays, first_stray = std::min(first_stray, i);
    } else if (match.of_scene[same] != kNone) {
      match.mismatch = "its vertices " + std::to_string(match.of_scene[same]) + " and " +
                       std::to_string(i) + " both lie on the scene's vertex " +
                       std::to_string(same) + " " + coordinates(scene[same]);
      return match;
    } else {
      match.of_scene[same] = i;
    }
  }
  if (strays > 0) {
    const auto [at, distance] = nearest(file[first_stray], scene);
    char buffer[256];
    std::snprintf(
        buffer, sizeof buffer,
        "%zu of its %zu vertices lie on none of the scene: its vertex %zu is at %s, %.4g m "
        "from the nearest, the scene's vertex %zu at %s (tolerance %.2g m)",
        strays, file.size(), first_stray, coordinates(file[first_stray]).c_str(), distance, at,
        coordinates(scene[at]).c_str(), tolerance);
    match.mismatch = buffer;
    return match;
  }
  match.farthest = farthest();
  return match;
}

}  // namespace taut::external
