#include "experiments/render/picture/placing.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/render/image/colour.hpp"

namespace taut {

namespace {

/// None of a plane, which has no end.
std::vector<Vec3> collider_points(const Collider& collider, double t) {
  const Shape shape = shape_at(collider, t);
  std::vector<Vec3> points;
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 0.0, 1.0})
      for (const double z : {-1.0, 0.0, 1.0}) {
        const Vec3 corner(x, y, z);
        if (const auto* ball = std::get_if<Ball>(&shape); ball && corner.norm() > 0)
          points.push_back(ball->center + ball->radius * corner.normalized());
        if (const auto* box = std::get_if<Box>(&shape))
          points.push_back(box->center + box->rotation * box->half_extents.cwiseProduct(corner));
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

/// Cloth at the times, relative to its centroid if the camera follows.
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

/// What the camera has to see: a collider that moves counts while it is at the cloth, not all the
/// way there and back.
std::vector<Vec3> points_of_interest(const Scene& scene, const std::vector<RecordedRun>& runs,
                                     const std::vector<Vec3>& cloth,
                                     const std::vector<double>& times) {
  std::vector<Vec3> points;
  for (const double t : times) {
    const auto at_cloth = widened(box_around(cloth_points(runs, {t}, false)), 0.1 * extent(scene));
    for (const Collider& collider : scene.colliders) {
      const std::vector<Vec3> solid = collider_points(collider, t);
      if (collider.motion.at_rest() || at_cloth.intersects(box_around(solid)))
        points.insert(points.end(), solid.begin(), solid.end());
    }
  }
  Eigen::AlignedBox3d near = box_around(scene.start.x).extend(box_around(points));
  // What is held swings within the cloth's own size; what lands spreads a little; down an endless
  // slope it slides.
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

/// The view, or its mirror image if the cloth shows more of itself there: farther spread across the
/// line of sight. A flag is not seen along its wind.
View telling_view(const View& view, const std::vector<Vec3>& cloth, const Vec3& up) {
  if (!view.either_side) return view;
  const auto spread = [&](const View& candidate) {
    const Vec3 right = fit_camera(cloth, up, candidate, 1, FitRegion{}).right.cast<double>();
    double sum = 0, squares = 0;
    for (const Vec3& x : cloth) sum += x.dot(right), squares += x.dot(right) * x.dot(right);
    const auto count = static_cast<double>(cloth.size());
    return squares / count - (sum / count) * (sum / count);
  };
  View mirrored = view;
  mirrored.azimuth = -view.azimuth;
  return spread(mirrored) > 1.1 * spread(view) ? mirrored : view;
}

}  // namespace

Vec3 centroid(const std::vector<RecordedRun>& runs, double t) {
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (const RecordedRun& run : runs)
    for (const Vec3& p : run.at(t).state.x) sum += p, count += 1;
  return sum / count;
}

GroundLight Placing::floor_below(const Vec3& point) const {
  GroundLight level;
  level.up = up.cast<float>();
  level.v = level.up.unitOrthogonal();
  level.u = level.v.cross(level.up);
  level.origin = (point + up * (ground - up.dot(point))).cast<float>();
  level.half_side = static_cast<float>(2.6 * radius);
  return level;
}

GroundLight Placing::wall(const Vec3& point) const {
  GroundLight wall;
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
  p.camera = fit_camera(points, p.up, telling_view(view, cloth, p.up), aspect, frame);
  p.floor = level_floor(scene, p.up);
  p.ground = p.floor ? std::get<Plane>(p.floor->shape).offset - inset : lowest - 0.08 * p.radius;
  p.cell = round_up(0.3 * p.radius, 1e-6);
  return p;
}

}  // namespace taut
