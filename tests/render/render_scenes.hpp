#pragma once

#include <cmath>

#include "experiments/render/picture/figure.hpp"

/// Prescribed motions, so that the contents of their pictures are known.
namespace taut::test {

/// A level sheet of n x n vertices, one metre wide.
inline Scene level_sheet(int n) {
  Scene scene;
  scene.name = "level";
  scene.mesh = make_sheet({.nu = n,
                           .nv = n,
                           .width = 1,
                           .height = 1,
                           .origin = Vec3(-0.5, 0, 0.5),
                           .v = -Vec3::UnitZ(),
                           .mass = 0.2});
  scene.links = grid_links(scene.mesh, {.structural = true, .shear = true});
  scene.start = {scene.mesh.rest, std::vector<Vec3>(scene.mesh.rest.size(), Vec3::Zero())};
  scene.dt = 1.0 / 64;
  scene.steps = 64;
  return scene;
}

/// Level sheet above a ball of radius 0.3.
inline Scene sheet_over_ball(int n) {
  Scene scene = level_sheet(n);
  scene.name = "over-ball";
  scene.colliders.push_back({Ball{Vec3(0, -0.31, 0), 0.3}, {}, 0});
  return scene;
}

inline Trajectory empty_trajectory(const Scene& scene) {
  return {"analytic:iterations=1", scene.dt, {}};
}

/// Run in which the sheet is stretched uniformly by 1 + strain at all times.
inline RecordedRun stretched(const Scene& scene, double strain) {
  Trajectory trajectory = empty_trajectory(scene);
  State state = scene.start;
  for (Vec3& x : state.x) x *= 1 + strain;
  for (int k = 0; k <= scene.steps; ++k) trajectory.frames.push_back({k * scene.dt, state});
  RecordedRun run = recorded_run(scene, trajectory);
  run.title = "Analytic";
  run.settings = "strain";
  run.colour = rgb(0x0B6BCB);
  return run;
}

/// Run in which the sheet is lowered on to the ball of `sheet_over_ball`. It bends along circles
/// around the top and folds into `folds` waves below.
inline RecordedRun draped(const Scene& scene, double folds) {
  Trajectory trajectory = empty_trajectory(scene);
  for (int k = 0; k <= scene.steps; ++k) {
    const double down = static_cast<double>(k) / scene.steps;
    State state = scene.start;
    for (Vec3& x : state.x) {
      const double r = std::hypot(x.x(), x.z()), a = std::atan2(x.z(), x.x());
      const double angle = std::min(r / 0.305, 1.2);
      const double rest = std::max(0.0, r - 0.305 * 1.2);
      const double wave = 1 + 0.25 * rest * std::cos(folds * a) * 4;
      const double out = (0.305 * std::sin(angle) + 0.35 * rest) * (rest > 0 ? wave : 1.0);
      const double y = -0.31 + 0.305 * std::cos(angle) - 0.93 * rest;
      x += down * (Vec3(out * std::cos(a), y, out * std::sin(a)) - x);
    }
    state.v.clear();  // left for the run to compute
    trajectory.frames.push_back({k * scene.dt, state});
  }
  RecordedRun run = recorded_run(scene, trajectory);
  run.title = "Analytic";
  run.settings = "drape";
  run.colour = rgb(0xC4501B);
  return run;
}

/// Options for small panels that draw quickly.
inline SceneRendererOptions small(ColourBy colour_by = ColourBy::strain) {
  SceneRendererOptions options;
  options.width = 240;
  options.height = 180;
  options.quality = RenderQuality::draft();
  options.colour_by = colour_by;
  return options;
}

/// Largest and mean difference of the channels of two images.
struct Difference {
  int largest = 0;
  double mean = 0;
};
inline Difference difference(const Image& a, const Image& b) {
  Difference d;
  if (a.width() != b.width() || a.height() != b.height()) return {255, 255};
  for (std::size_t i = 0; i < a.pixels().size(); ++i) {
    const Rgb8 p = a.pixels()[i], q = b.pixels()[i];
    for (const int delta : {p.r - q.r, p.g - q.g, p.b - q.b}) {
      d.largest = std::max(d.largest, std::abs(delta));
      d.mean += std::abs(delta) / (3.0 * static_cast<double>(a.pixels().size()));
    }
  }
  return d;
}

}  // namespace taut::test
