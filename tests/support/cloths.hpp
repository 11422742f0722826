#pragma once

#include <algorithm>
#include <string>

#include "core/model/solver.hpp"

namespace taut {

/// Sheet of nu x nv vertices, 1 m wide, flat and at rest, with all three families of links, pinned
/// by its two upper corners; dt = 1/64 s.
inline Scene hanging_sheet(int nu, int nv, const LinkChoice& families = {true, true, true},
                           Lumping lumping = Lumping::area) {
  Scene scene;
  scene.name = "hang";
  const double height = nu > 1 ? (nv - 1.0) / (nu - 1) : 1;
  scene.mesh = make_sheet(
      {.nu = nu, .nv = nv, .width = 1, .height = height, .mass = 0.2, .lumping = lumping});
  const auto n = static_cast<std::size_t>(scene.mesh.size());
  scene.start = {scene.mesh.rest, std::vector<Vec3>(n, Vec3::Zero())};
  scene.links = grid_links(scene.mesh, families);
  scene.pins = nu > 1 ? std::vector{0, nu - 1} : std::vector{0};
  scene.dt = 1.0 / 64;
  scene.steps = 64;
  return scene;
}

/// Displaces every vertex by up to `amount` [m] in a fixed pattern without symmetry.
inline Scene crumpled(Scene scene, double amount) {
  for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
    const auto noise = [&](std::size_t axis) {  // computed from integers, the same on every machine
      return static_cast<double>((i * 7919 + axis * 104729 + i * i * 31) % 2001) / 1000 - 1;
    };
    const Vec3 wave(noise(0), noise(1), noise(2));
    if (!std::binary_search(scene.pins.begin(), scene.pins.end(), static_cast<int>(i)))
      scene.start.x[i] += amount * wave;
  }
  return scene;
}

/// Level sheet at this height [m], about to meet an obstacle below.
inline Scene sheet_above(double y) {
  Scene scene = hanging_sheet(13, 13);
  for (std::vector<Vec3>* places : {&scene.mesh.rest, &scene.start.x})
    for (Vec3& x : *places) x = Vec3(x.x() - 0.47, y, x.y() + 0.52);
  for (Vec3& v : scene.start.v) v = {0.1, -0.4, 0.05};
  scene.pins.clear();
  scene.thickness = 0.005;
  return scene;
}

/// "jakobsen:..." as in Jakobsen's listing, with one substep and links in the scene's own order,
/// unless `params` ("iterations=8,order=reversed") sets these.
inline std::string listing(const std::string& params = "") {
  const auto open = [&](const char* key) { return params.find(key) == std::string::npos; };
  std::string text = "jakobsen:";
  if (open("substeps=")) text += "substeps=1,";
  if (open("order=")) text += "order=mesh,";
  if (params.empty()) text.pop_back();
  return text + params;
}

inline State simulate(const Scene& scene, const std::string& solver, int steps) {
  const SolverChoice choice = parse_solver(solver);
  const auto instance = choice.entry->make(scene, choice.params);
  instance->load(scene.start);
  for (int n = 0; n < steps; ++n) instance->step(n * scene.dt, scene.dt);
  State state;
  instance->store(state);
  return state;
}

inline double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

}  // namespace taut
