#include "experiments/render/picture/scene_renderer.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/index.hpp"
#include "core/model/input_error.hpp"
#include "core/model/triangle_mesh.hpp"

namespace taut {

namespace {

bool is_sound(const State& state, const Vec3& centre, double reach) {
  return std::ranges::all_of(
      state.x, [&](const Vec3& p) { return p.allFinite() && (p - centre).norm() <= reach; });
}

/// Fills in velocities that a trajectory lacks: backward differences, as Verlet has them; for the
/// first frame, the scene's initial velocities.
void add_velocities(const Scene& scene, std::vector<Frame>& frames) {
  for (std::size_t k = 0; k < frames.size(); ++k) {
    State& now = frames[k].state;
    if (!now.v.empty()) continue;
    now.v = scene.start.v;
    const double dt = k > 0 ? frames[k].t - frames[k - 1].t : 0;
    if (dt <= 0) continue;
    for (std::size_t i = 0; i < now.x.size(); ++i)
      now.v[i] = (now.x[i] - frames[k - 1].state.x[i]) / dt;
  }
}

double strain(const Link& link, const State& state) {
  return ((state.x[to_index(link.b)] - state.x[to_index(link.a)]).norm() - link.rest) / link.rest;
}

std::vector<double> vertex_strains(const Scene& scene, const State& state) {
  std::vector<double> sum(state.x.size(), 0.0), count(state.x.size(), 0.0);
  for (const Link& link : scene.links) {
    if (link.family == Family::bend) continue;
    const double e = strain(link, state);
    for (const int end : {link.a, link.b}) {
      sum[to_index(end)] += e;
      count[to_index(end)] += 1;
    }
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

/// Points that span a collider. A plane has no end and yields none.
std::vector<Vec3> collider_points(const Collider& collider, double t) {
  const Shape shape = shape_at(collider, t);
  std::vector<Vec3> points;
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 0.0, 1.0})
      for (const double z : {-1.0, 0.0, 1.0}) {
        const Vec3 corner(x, y, z);
        if (const auto* ball = std::get_if<Ball>(&shape); ball && corner.norm() > 0)
          points.push_back(ball->center + ball->radius * corner.normalized());
        if (const auto* capsule = std::get_if<Capsule>(&shape); capsule && corner.norm() > 0)
          for (const Vec3& end : {capsule->from, capsule->to})
            points.push_back(end + capsule->radius * corner.normalized());
        if (const auto* box = std::get_if<Box>(&shape))
          points.push_back(box->center + box->rotation * box->half_extents.cwiseProduct(corner));
        if (const auto* body = std::get_if<MeshBody>(&shape)) {
          const Eigen::AlignedBox3d& around = body->mesh->box();
          points.push_back(body->center +
                           body->rotation *
                               (around.center() + around.sizes().cwiseProduct(corner) / 2));
        }
      }
  return points;
}

Eigen::AlignedBox3d box_around(const std::vector<Vec3>& points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : points) box.extend(x);
  return box;
}

Eigen::AlignedBox3d widened(const Eigen::AlignedBox3d& box, double margin) {
  return {box.min() - Vec3::Constant(margin), box.max() + Vec3::Constant(margin)};
}

const Collider* level_floor(const Scene& scene, const Vec3& up) {
  for (const Collider& collider : scene.colliders)
    if (const auto* plane = std::get_if<Plane>(&collider.shape);
        plane && collider.motion.at_rest() && plane->normal.dot(up) > 0.9999)
      return &collider;
  return nullptr;
}

/// Positions of the cloth at these times, relative to its centroid if the camera follows it.
std::vector<Vec3> cloth_points(const std::vector<RecordedRun>& runs,
                               const std::vector<double>& times, bool follows) {
  std::vector<Vec3> points;
  for (const double t : times) {
    const Vec3 moved = follows ? centroid(runs, t) : Vec3::Zero();
    for (const RecordedRun& run : runs)
      for (const Vec3& x : run.at(t).state.x) points.emplace_back(x - moved);
  }
  return points;
}

/// Points that the camera has to see. A moving collider counts only while it is at the cloth.
std::vector<Vec3> points_of_interest(const Scene& scene, const std::vector<RecordedRun>& runs,
                                     const std::vector<Vec3>& cloth,
                                     const std::vector<double>& times) {
  std::vector<Vec3> points;
  for (const double t : times) {
    const auto at_cloth = widened(box_around(cloth_points(runs, {t}, false)), 0.1 * extent(scene));
    for (const Collider& collider : scene.colliders) {
      const std::vector<Vec3> solid = collider_points(collider, t);
      if (collider.at_rest() || at_cloth.intersects(box_around(solid)))
        points.insert(points.end(), solid.begin(), solid.end());
    }
  }
  Eigen::AlignedBox3d near = box_around(scene.start.x).extend(box_around(points));
  // Cloth that is held swings within its own size, cloth that lands spreads a little, and cloth on
  // an endless slope slides far.
  const bool slope = std::ranges::any_of(scene.colliders, [&](const Collider& collider) {
    const auto* plane = std::get_if<Plane>(&collider.shape);
    return plane && plane->normal.dot(up_direction(scene)) < 0.9999;
  });
  const double share = slope ? 3 : scene.pins.empty() ? 0.3 : 0.6;
  near = widened(near, share * extent(scene));
  for (const Vec3& x : cloth)
    if (near.contains(x)) points.push_back(x);
  return points.empty() ? scene.start.x : points;
}

/// The view, or its mirror image if the cloth spreads more across the line of sight there: a flag
/// seen along its wind shows little.
View better_side(const View& view, const std::vector<Vec3>& cloth, const Vec3& up) {
  if (!view.either_side) return view;
  const auto spread = [&](const View& candidate) {
    const Vec3 right = fit_camera(cloth, up, candidate, 1, FitRegion{}).right.cast<double>();
    double sum = 0, squares = 0;
    for (const Vec3& x : cloth) {
      sum += x.dot(right);
      squares += x.dot(right) * x.dot(right);
    }
    const auto count = static_cast<double>(cloth.size());
    return squares / count - (sum / count) * (sum / count);
  };
  View mirrored = view;
  mirrored.azimuth = -view.azimuth;
  return spread(mirrored) > 1.1 * spread(view) ? mirrored : view;
}

}  // namespace

const Frame& RecordedRun::at(double t) const {
  const auto& frames = trajectory.frames;
  const auto after = std::ranges::lower_bound(frames, t, {}, &Frame::t);
  if (after == frames.begin()) return *after;
  if (after == frames.end()) return frames.back();
  return t - std::prev(after)->t <= after->t - t ? *std::prev(after) : *after;
}

RecordedRun recorded_run(const Scene& scene, Trajectory trajectory, double reach) {
  RecordedRun run;
  auto& frames = trajectory.frames;
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : scene.start.x) centre += p / scene.mesh.size();
  const double limit =
      reach * extent(scene) + scene.gravity.norm() * scene.duration() * scene.duration();
  const auto bad = std::ranges::find_if_not(
      frames, [&](const auto& frame) { return is_sound(frame.state, centre, limit); });
  const bool exploded = bad != frames.end();
  frames.erase(bad, frames.end());
  if (frames.empty())
    throw InputError("the trajectory of '" + trajectory.solver +
                     "' has no stable frame: there is nothing to draw");
  add_velocities(scene, frames);
  const double slack = 1.5 * std::max(trajectory.frame_dt, scene.dt);
  if (exploded || frames.back().t < scene.duration() - slack)
    run.stop = RecordedRun::Stop{frames.back().t, exploded ? "exploded" : "ended"};
  run.trajectory = std::move(trajectory);
  return run;
}

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
    if (link.family == Family::bend || is_seam(link) || (pinned(link.a) && pinned(link.b)))
      continue;
    const double e = strain(link, state);
    figures.max_strain = std::max(figures.max_strain, std::abs(e));
    sum += e;
    squares += e * e;
    count += 1;
  }
  if (count > 0) {
    figures.mean_strain = sum / count;
    figures.rms_strain = std::sqrt(squares / count);
  }
  for (const double depth : vertex_depths(scene, state, t))
    figures.max_depth = std::max(figures.max_depth, depth);
  for (const Vec3& v : state.v) figures.max_speed = std::max(figures.max_speed, v.norm());
  return figures;
}

Vec3 centroid(const std::vector<RecordedRun>& runs, double t) {
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (const RecordedRun& run : runs)
    for (const Vec3& p : run.at(t).state.x) {
      sum += p;
      count += 1;
    }
  return sum / count;
}

Ground Placing::floor_below(const Vec3& point) const {
  Ground level;
  level.up = up.cast<float>();
  level.v = level.up.unitOrthogonal();
  level.u = level.v.cross(level.up);
  level.origin = (point + up * (ground - up.dot(point))).cast<float>();
  level.half_side = static_cast<float>(2.6 * radius);
  return level;
}

Ground Placing::wall(const Vec3& point) const {
  Ground wall;
  wall.up = up.cast<float>();
  wall.u = camera.right;
  wall.v = wall.up;
  const double height = up.dot(point);
  const Vec3 behind = point - 1.4 * radius * camera.back.cast<double>();
  const double snapped = std::round(height / cell) * cell;
  wall.origin = (behind + up * (snapped - up.dot(behind))).cast<float>();
  wall.half_side = static_cast<float>(2.2 * radius);
  return wall;
}

Placing place(const Scene& scene, const std::vector<RecordedRun>& runs,
              const std::vector<double>& times, const View& view, const FitRegion& frame,
              double aspect, double inset) {
  Placing p;
  p.up = up_direction(scene);
  p.follows = scene.pins.empty() && scene.colliders.empty();
  p.inset = inset;
  const std::vector<Vec3> cloth = cloth_points(runs, times, p.follows);
  const std::vector<Vec3> points =
      p.follows ? cloth : points_of_interest(scene, runs, cloth, times);
  p.centre = box_around(points).center();
  p.radius = 0;
  double lowest = 1e300;
  for (const Vec3& x : points) {
    p.radius = std::max(p.radius, (x - p.centre).norm());
    lowest = std::min(lowest, x.dot(p.up));
  }
  p.camera = fit_camera(points, p.up, better_side(view, cloth, p.up), aspect, frame);
  p.floor = level_floor(scene, p.up);
  p.ground = p.floor ? std::get<Plane>(p.floor->shape).offset - inset : lowest - 0.08 * p.radius;
  p.cell = round_up(0.3 * p.radius, 1e-6);
  return p;
}

SceneRenderer::SceneRenderer(const Scene& scene, const std::vector<RecordedRun>& runs,
                             const SceneRendererOptions& options)
    : scene_(scene),
      runs_(runs),
      options_(options),
      scale_{options.colour_by, options.range},
      mesher_(scene, options.quality.finest_sheet),
      renderer_(gl_, options.width, options.height, options.quality.supersampling,
                options.quality.light),
      last_(runs.size()) {
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

/// Ends the bar at a round number that 98 of 100 vertices do not exceed. Runs that blew up are
/// ignored if any run is stable, and strain ends at 100 %; otherwise everything stable would look
/// unstrained.
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

std::vector<RenderMesh> SceneRenderer::meshes(const Frame& frame, const Vec3& centre) const {
  std::vector<RenderMesh> meshes{
      mesher_.mesh(frame.state.x, vertex_values(scene_, scale_.colour_by, frame.state, frame.t),
                   vertex_values(scene_, ColourBy::penetration, frame.state, frame.t))};
  lift_out_of_colliders(meshes[0], scene_, frame.t, placing_.inset);
  const ColliderLook look{placing_.inset, 0.7 * mesher_.mean_rest_length(), centre,
                          1.2 * placing_.radius, options_.quality.segments};
  for (const Collider& collider : scene_.colliders)
    if (&collider != placing_.floor) meshes.push_back(collider_mesh(collider, frame.t, look));
  RenderMesh& pins = meshes.emplace_back();
  for (const int pin : pins_at(scene_, frame.t))
    append_ball(pins, frame.state.x[to_index(pin)].cast<float>(),
                static_cast<float>(0.009 * extent(scene_)), options_.quality.segments / 4, 0);
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
  const Frame& frame = runs_[index].at(t);
  Drawn& last = last_[index];
  if (last.frame != &frame) last = {&frame, draw(frame)};
  return last.image;
}

Image SceneRenderer::draw(const Frame& frame) const {
  const Vec3 moved = placing_.follows ? centroid(runs_, frame.t) : Vec3::Zero();
  const Vec3 centre = placing_.centre + moved;
  const std::vector<RenderMesh> meshes = this->meshes(frame, centre);
  Panel panel{.camera = placing_.camera,
              .theme = options_.theme,
              .scale = scale_,
              .ground = placing_.follows ? placing_.wall(centre) : placing_.floor_below(centre),
              .lights = lights_,
              .casters = {centre.cast<float>(), static_cast<float>(1.02 * placing_.radius)},
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
  // Linear interpolation between the vertices; the outermost vertices lie on the border.
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
