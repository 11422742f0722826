#pragma once

// Plain sheet, and all metrics of a motion that a test prescribes.

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>

#include "experiments/metrics/metric.hpp"
#include "tests/support/draw.hpp"

namespace taut {

using Values = std::map<std::string, double>;

/// Sheet of n x n vertices, 1 m x 1 m in the plane y = 0, all families of links, 3 s in steps of
/// 1/64 s.
inline Scene sheet(int n = 11) {
  Scene scene;
  scene.mesh =
      make_sheet({.nu = n, .nv = n, .width = 1, .height = 1, .v = Vec3::UnitZ(), .mass = 0.5});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true, .bend = true});
  scene.dt = 1.0 / 64;
  scene.steps = 192;
  return scene;
}

/// Every value of every applicable metric for the motion x(step).
template <class Motion>
Values measure(const Scene& scene, const Motion& motion) {
  Values values;
  for (const MetricEntry* entry : metrics()) {
    const auto metric = entry->make(scene);
    if (!metric) continue;
    for (int step = 0; step <= scene.steps; ++step) {
      const State state = step == 0 ? scene.start : motion(step);
      metric->observe({step, step * scene.dt, state});
    }
    const auto numbers = metric->finish();
    EXPECT_EQ(numbers.size(), entry->values.size()) << entry->name;
    for (std::size_t k = 0; k < numbers.size(); ++k)
      values[std::string(entry->values[k].name)] = numbers[k];
  }
  return values;
}

inline Values measure_at_rest(const Scene& scene, const State& state) {
  return measure(scene, [&](int) { return state; });
}

/// Distance of a point from a surface [m], negative inside.
inline double signed_distance(const Shape& shape, const Vec3& p) {
  if (const auto* plane = std::get_if<Plane>(&shape)) return plane->normal.dot(p) - plane->offset;
  if (const auto* ball = std::get_if<Ball>(&shape)) return (p - ball->center).norm() - ball->radius;
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    const Vec3 along = capsule->to - capsule->from, from = p - capsule->from;
    if (along.dot(from) < 0) return from.norm() - capsule->radius;
    if (along.dot(p - capsule->to) > 0) return (p - capsule->to).norm() - capsule->radius;
    return along.cross(from).norm() / along.norm() - capsule->radius;
  }
  const Box& box = std::get<Box>(shape);
  const Vec3 q = (box.rotation.inverse() * (p - box.center)).cwiseAbs() - box.half_extents;
  return q.maxCoeff() < 0 ? q.maxCoeff() : q.cwiseMax(0).norm();
}

inline std::size_t middle(const Scene& s) { return s.mesh.rest.size() / 2; }

}  // namespace taut
