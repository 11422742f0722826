#pragma once

#include <array>
#include <memory>
#include <random>
#include <vector>

#include "core/model/collider.hpp"
#include "core/model/triangle_mesh.hpp"

namespace taut {

/// Numbers for random inputs, the same in every run.
class Random {
 public:
  explicit Random(unsigned seed = 20) : engine_(seed) {}
  /// In [-bound, bound).
  double within(double bound) { return std::uniform_real_distribution<>(-bound, bound)(engine_); }
  double between(double low, double high) { return (low + high) / 2 + within((high - low) / 2); }
  Vec3 point(double bound) {
    const double x = within(bound), y = within(bound);
    return {x, y, within(bound)};
  }

 private:
  std::mt19937_64 engine_;
};

/// A box of 12 triangles about the origin; half: its half extents [m].
inline std::shared_ptr<const TriangleMesh> body_of_a_box(const Vec3& half) {
  std::vector<Vec3> corners;
  for (const int v : {0, 1, 2, 3, 4, 5, 6, 7})
    corners.emplace_back((v & 1) != 0 ? half.x() : -half.x(), (v & 2) != 0 ? half.y() : -half.y(),
                         (v & 4) != 0 ? half.z() : -half.z());
  constexpr std::array<std::array<int, 4>, 6> kSides{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  std::vector<Triangle> triangles;
  for (const auto& [a, b, c, d] : kSides) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  }
  return std::make_shared<const TriangleMesh>(corners, triangles);
}

/// A convex prism along z over the polygon through these points of the x-y plane,
/// counter-clockwise. half: half of its length [m].
inline std::shared_ptr<const TriangleMesh> prism(const std::vector<Vec3>& polygon, double half) {
  std::vector<Vec3> corners;
  std::vector<Triangle> triangles;
  const int n = static_cast<int>(polygon.size());
  for (const double z : {-half, half})
    for (const Vec3& p : polygon) corners.emplace_back(p.x(), p.y(), z);
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    triangles.push_back({k, next, n + next});
    triangles.push_back({k, n + next, n + k});
    if (k == 0 || next == 0) continue;
    triangles.push_back({0, next, k});
    triangles.push_back({n, n + k, n + next});
  }
  return std::make_shared<const TriangleMesh>(corners, triangles);
}

}  // namespace taut
