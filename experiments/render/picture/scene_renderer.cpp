#include "experiments/render/picture/scene_renderer.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/index.hpp"

namespace taut {

SceneRenderer::SceneRenderer(const Scene& scene, const std::vector<RecordedRun>& runs,
                             const SceneRendererOptions& options)
    : scene_(scene),
      runs_(runs),
      options_(options),
      scale_{options.colour_by, options.range},
      mesher_(scene, options.quality.finest_sheet),
      renderer_(gl_, options.width, options.height, options.quality.supersampling) {
  options_.to = std::min(options_.to, scene.duration());
  choose_scale();
  placing_ =
      place(scene, runs, sampled_times(), options_.view, options_.frame,
            static_cast<double>(options.width) / options.height, 0.05 * mesher_.mean_rest_length());
  lights_ = light_set(options.quality.light.lights, placing_.up.cast<float>(), placing_.camera);
}

std::vector<double> SceneRenderer::sampled_times() const {
  const int samples = options_.to > options_.from ? 24 : 0;
  std::vector<double> times{options_.from};
  for (int k = 1; k <= samples; ++k)
    times.push_back(options_.from + (options_.to - options_.from) * k / samples);
  return times;
}

/// The bar ends at a round number that 98 of 100 vertices do not exceed. A run that blew up has no
/// say beside stable ones, and strain ends at 100 %: else all that is stable would look unstrained.
void SceneRenderer::choose_scale() {
  if (scale_.high > 0) return;
  constexpr double kMostStrain = 1;
  const auto stable = [](const RecordedRun& run) { return !run.stop; };
  const bool any_stable = std::ranges::any_of(runs_, stable);
  std::vector<double> magnitudes;
  for (const double t : sampled_times())
    for (const RecordedRun& run : runs_) {
      if (any_stable && !stable(run)) continue;
      for (const double v : vertex_values(scene_, scale_.colour_by, run.at(t).state, run.at(t).t))
        if (std::isfinite(v)) magnitudes.push_back(std::abs(v));
    }
  const auto rank = static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(magnitudes.size() - 1));
  std::nth_element(magnitudes.begin(), magnitudes.begin() + rank, magnitudes.end());
  const double least = scale_.colour_by == ColourBy::strain        ? 1e-3
                       : scale_.colour_by == ColourBy::penetration ? 1e-3 * extent(scene_)
                                                                   : 0.1;
  scale_.high = round_up(magnitudes[static_cast<std::size_t>(rank)], least);
  if (scale_.colour_by == ColourBy::strain) scale_.high = std::min(scale_.high, kMostStrain);
}

std::vector<RenderMesh> SceneRenderer::meshes(const TrajectoryReader::Frame& frame,
                                              const Vec3& centre) const {
  std::vector<RenderMesh> meshes{
      mesher_.mesh(frame.state.x, vertex_values(scene_, scale_.colour_by, frame.state, frame.t),
                   vertex_values(scene_, ColourBy::penetration, frame.state, frame.t))};
  lift_out_of_colliders(meshes[0], scene_, frame.t, placing_.inset);
  const ColliderLook look{placing_.inset, 0.7 * mesher_.mean_rest_length(), centre,
                          1.2 * placing_.radius};
  for (const Collider& collider : scene_.colliders)
    if (&collider != placing_.floor) meshes.push_back(collider_mesh(collider, frame.t, look));
  RenderMesh& pins = meshes.emplace_back();
  for (const int pin : scene_.pins)
    append_ball(pins, frame.state.x[to_index(pin)].cast<float>(),
                static_cast<float>(0.009 * extent(scene_)), 16, 0);
  return meshes;
}

std::vector<Eigen::Vector2f> SceneRenderer::projected(std::size_t run, double t) const {
  const auto& frame = runs_[run].at(t);
  Camera camera = placing_.camera;
  if (placing_.follows) camera.eye += centroid(runs_, frame.t).cast<float>();
  const Eigen::Matrix4f to_clip = camera.world_to_clip(static_cast<float>(options_.width) /
                                                       static_cast<float>(options_.height));
  std::vector<Eigen::Vector2f> points;
  for (const Vec3& x : frame.state.x) {
    const Eigen::Vector4f clip = to_clip * x.cast<float>().homogeneous();
    if (clip.w() > 0) points.emplace_back(clip.head<2>() / clip.w());
  }
  return points;
}

bool SceneRenderer::in_sight(std::size_t run, double t) const {
  return std::ranges::any_of(projected(run, t), [](const Eigen::Vector2f& p) {
    return std::abs(p.x()) < 1 && std::abs(p.y()) < 1;
  });
}

Image SceneRenderer::panel(std::size_t index, double t) const {
  const auto& frame = runs_[index].at(t);
  const Vec3 moved = placing_.follows ? centroid(runs_, frame.t) : Vec3::Zero();
  const Vec3 centre = placing_.centre + moved;
  std::vector<RenderMesh> meshes = this->meshes(frame, centre);
  GroundLight ground = placing_.follows ? placing_.wall(centre) : placing_.floor_below(centre);
  bake_light(lights_, options_.quality.light,
             {centre.cast<float>(), static_cast<float>(1.02 * placing_.radius)}, meshes, ground);
  Panel panel{.camera = placing_.camera,
              .theme = options_.theme,
              .scale = scale_,
              .ground = &ground,
              .ground_cell = static_cast<float>(placing_.cell),
              .hatch_depth = static_cast<float>(hatch_depth())};
  panel.camera.eye += moved.cast<float>();
  panel.painted.push_back({&meshes.front(), {}, mesher_.grid_spacing()});
  for (std::size_t i = 1; i + 1 < meshes.size(); ++i)
    panel.painted.push_back({&meshes[i], options_.theme.collider, 0});
  if (!meshes.back().triangles.empty())
    panel.painted.push_back({&meshes.back(), options_.theme.pin, 0});
  return renderer_.draw(panel);
}

Image SceneRenderer::material_space(std::size_t index, double t, int longest_side) const {
  if (!scene_.mesh.grid) return {};
  const Grid& grid = *scene_.mesh.grid;
  const auto& frame = runs_[index].at(t);
  const std::vector<double> values = vertex_values(scene_, scale_.colour_by, frame.state, frame.t);
  const auto side = [&](int from, int to) {
    return (scene_.mesh.rest[to_index(to)] - scene_.mesh.rest[to_index(from)]).norm();
  };
  const double across = side(grid.index(0, 0), grid.index(grid.nu - 1, 0));
  const double down = side(grid.index(0, 0), grid.index(0, grid.nv - 1));
  const double scale = longest_side / std::max(across, down);
  Image image(std::max(longest_side / 9, static_cast<int>(std::lround(across * scale))),
              std::max(longest_side / 9, static_cast<int>(std::lround(down * scale))));
  // Linear between the vertices; the outermost vertices lie on the border.
  const auto locate = [](int pixel, int pixels, int vertices) {
    const double s = std::clamp((pixel + 0.5) / pixels, 0.0, 1.0) * (vertices - 1);
    const int i = std::min(static_cast<int>(s), std::max(vertices - 2, 0));
    return std::pair{i, s - i};
  };
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const auto [i, a] = locate(x, image.width(), grid.nu);
      const auto [j, b] = locate(y, image.height(), grid.nv);
      const auto at = [&, i = i, j = j](int di, int dj) {
        return values[to_index(
            grid.index(std::min(i + di, grid.nu - 1), std::min(j + dj, grid.nv - 1)))];
      };
      image.at(x, y) = scale_.colour((1 - b) * ((1 - a) * at(0, 0) + a * at(1, 0)) +
                                     b * ((1 - a) * at(0, 1) + a * at(1, 1)));
    }
  return image;
}

}  // namespace taut
