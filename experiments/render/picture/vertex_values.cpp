#include "experiments/render/picture/vertex_values.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/index.hpp"

namespace taut {

namespace {

double strain(const Link& link, const State& state) {
  return ((state.x[to_index(link.b)] - state.x[to_index(link.a)]).norm() - link.rest) / link.rest;
}

std::vector<double> vertex_strains(const Scene& scene, const State& state) {
  std::vector<double> sum(state.x.size(), 0.0), count(state.x.size(), 0.0);
  for (const Link& link : scene.links) {
    if (link.family == Family::bend) continue;
    const double e = strain(link, state);
    for (const int end : {link.a, link.b}) sum[to_index(end)] += e, count[to_index(end)] += 1;
  }
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(count[i], 1.0);
  return sum;
}

std::vector<double> vertex_depths(const Scene& scene, const State& state, double t) {
  std::vector<double> depth(state.x.size(), 0.0);
  for (const Collider& collider : scene.colliders) {
    const Shape shape = shape_at(collider, t);
    for (std::size_t i = 0; i < depth.size(); ++i)
      depth[i] = std::max(depth[i], -surface(shape, state.x[i]).distance);
  }
  return depth;
}

}  // namespace

std::vector<double> vertex_values(const Scene& scene, ColourBy colour_by, const State& state,
                                  double t) {
  if (colour_by == ColourBy::strain) return vertex_strains(scene, state);
  if (colour_by == ColourBy::penetration) return vertex_depths(scene, state, t);
  std::vector<double> speed(state.x.size(), 0.0);
  for (std::size_t i = 0; i < state.v.size(); ++i) speed[i] = state.v[i].norm();
  return speed;
}

LiveFigures live_figures(const Scene& scene, const State& state, double t) {
  LiveFigures figures;
  const auto pinned = [&](int i) {
    return std::binary_search(scene.pins.begin(), scene.pins.end(), i);
  };
  double sum = 0, squares = 0, count = 0;
  for (const Link& link : scene.links) {
    if (link.family == Family::bend || (pinned(link.a) && pinned(link.b))) continue;
    const double e = strain(link, state);
    figures.max_strain = std::max(figures.max_strain, std::abs(e));
    sum += e, squares += e * e, count += 1;
  }
  if (count > 0) figures.mean_strain = sum / count, figures.rms_strain = std::sqrt(squares / count);
  for (const double depth : vertex_depths(scene, state, t))
    figures.max_depth = std::max(figures.max_depth, depth);
  for (const Vec3& v : state.v) figures.max_speed = std::max(figures.max_speed, v.norm());
  return figures;
}

}  // namespace taut
