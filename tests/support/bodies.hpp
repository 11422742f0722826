#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/model/index.hpp"
#include "core/model/scene.hpp"
#include "core/model/triangle_mesh.hpp"

// Bodies of triangles with closed forms for tests.

namespace taut {

struct Triangles {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  std::shared_ptr<const TriangleMesh> mesh() const {
    return std::make_shared<const TriangleMesh>(vertices, triangles);
  }
};

/// Box with two triangles per side.
inline Triangles box_of_triangles(const Vec3& half) {
  Triangles box;
  for (const int v : {0, 1, 2, 3, 4, 5, 6, 7})
    box.vertices.emplace_back((v & 1) != 0 ? half.x() : -half.x(),
                              (v & 2) != 0 ? half.y() : -half.y(),
                              (v & 4) != 0 ? half.z() : -half.z());
  const std::array<std::array<int, 4>, 6> sides{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& [a, b, c, d] : sides) {
    box.triangles.push_back({a, b, c});
    box.triangles.push_back({a, c, d});
  }
  return box;
}

inline Triangles pyramid(double side, double height) {
  const double h = side / 2;
  return {{{-h, 0, -h}, {h, 0, -h}, {h, 0, h}, {-h, 0, h}, {0, height, 0}},
          {{0, 1, 2}, {0, 2, 3}, {0, 4, 1}, {1, 4, 2}, {2, 4, 3}, {3, 4, 0}}};
}

/// Octahedron on a sphere, with triangles split into four `times` times.
inline Triangles ball_of_triangles(double radius, int times) {
  Triangles ball{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int n = 0; n < times; ++n) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, fresh] =
          middles.emplace(std::minmax(a, b), static_cast<int>(ball.vertices.size()));
      if (fresh)
        ball.vertices.push_back(
            (ball.vertices[to_index(a)] + ball.vertices[to_index(b)]).normalized());
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : ball.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    ball.triangles = finer;
  }
  for (Vec3& x : ball.vertices) x *= radius;
  return ball;
}

/// Torus about the y axis. `bumps` [m] displaces its vertices along the tube's radius.
inline Triangles torus(double radius, double tube, int around, int across, double bumps = 0) {
  Triangles body;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double r = tube + bumps * std::sin(7.3 * i + 11.9 * j);
      body.vertices.emplace_back((radius + r * std::cos(v)) * std::cos(u), r * std::sin(v),
                                 (radius + r * std::cos(v)) * std::sin(u));
      const auto at = [&](int a, int b) { return (i + a) % around * across + (j + b) % across; };
      body.triangles.push_back({at(0, 0), at(0, 1), at(1, 0)});
      body.triangles.push_back({at(1, 0), at(0, 1), at(1, 1)});
    }
  return body;
}

/// Height [m] of the walls on both sides of grooves along z. The grooves are a fifth as wide.
constexpr double kGrooves = 0.5;
inline Triangles grooved_sheet() {
  Triangles body;
  constexpr int kWalls = 40;
  for (int i = 0; i <= kWalls; ++i) {
    const double x = 0.05 * (i - kWalls / 2), y = i % 2 == 0 ? kGrooves : 0;
    body.vertices.emplace_back(x, y, -2);
    body.vertices.emplace_back(x, y, 2);
    if (i == kWalls) continue;
    body.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 2});
    body.triangles.push_back({2 * i + 2, 2 * i + 1, 2 * i + 3});
  }
  return body;
}
/// Number of vertices below the grooved sheet.
inline int below_grooves(const State& state) {
  return static_cast<int>(std::ranges::count_if(state.x, [](const Vec3& x) {
    return std::abs(x.x()) < 1 &&
           x.y() < kGrooves / 0.05 * std::abs(std::remainder(x.x() - 0.05, 0.1));
  }));
}

}  // namespace taut
