#include "experiments/render/opengl/camera.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>

#include "core/io/scene_io.hpp"
#include "core/model/input_error.hpp"

namespace taut {

namespace {
constexpr double kRadians = std::numbers::pi / 180;
constexpr double kTanHalfHeight = 0.22;
}  // namespace

View parse_view(const std::string& text) {
  static const std::map<std::string, View> named{
      {"three-quarter", {}},     {"front", {0, 6, false}},  {"back", {180, 6, false}},
      {"left", {-90, 6, false}}, {"right", {90, 6, false}}, {"top", {0, 89, false}},
  };
  if (const auto found = named.find(text); found != named.end()) return found->second;
  const std::size_t comma = text.find(',');
  if (comma != std::string::npos) {
    const View view{parse_number(text.substr(0, comma)), parse_number(text.substr(comma + 1)),
                    false};
    if (std::abs(view.azimuth) <= 360 && std::abs(view.elevation) < 90) return view;
  }
  std::vector<std::string> names;
  for (const auto& [name, view] : named) names.push_back(name);
  throw InputError("unknown view '" + text +
                   "': three-quarter, front, back, left, right, top or AZIMUTH,ELEVATION in "
                   "degrees (elevation between -90 and 90)" +
                   suggestion(text, names));
}

Eigen::Matrix4f Camera::world_to_clip(float aspect) const {
  Eigen::Matrix4f view = Eigen::Matrix4f::Identity();
  view.row(0) << right.transpose(), -right.dot(eye);
  view.row(1) << up.transpose(), -up.dot(eye);
  view.row(2) << back.transpose(), -back.dot(eye);
  Eigen::Matrix4f projection = Eigen::Matrix4f::Zero();
  projection(0, 0) = 1 / (tan_half_height * aspect);
  projection(1, 1) = 1 / tan_half_height;
  projection(2, 2) = -(far_plane + near_plane) / (far_plane - near_plane);
  projection(2, 3) = -2 * far_plane * near_plane / (far_plane - near_plane);
  projection(3, 2) = -1;
  return projection * view;
}

Vec3 up_direction(const Scene& scene) {
  return scene.gravity.norm() > 0 ? Vec3(-scene.gravity.normalized()) : Vec3::UnitY();
}

namespace {

/// Camera with its orientation set but not its position.
Camera turned(const Vec3& up, const View& view) {
  // Azimuth 0 is the level part of +z, or of +x if up is along z.
  Vec3 ahead = Vec3::UnitZ() - up * up.z();
  if (ahead.norm() < 0.1) ahead = Vec3::UnitX() - up * up.x();
  ahead.normalize();
  const Vec3 side = up.cross(ahead);
  const double azimuth = view.azimuth * kRadians, elevation = view.elevation * kRadians;
  const Vec3 level = ahead * std::cos(azimuth) + side * std::sin(azimuth);
  const Vec3 back = level * std::cos(elevation) + up * std::sin(elevation);
  const Vec3 right = up.cross(level);
  Camera camera;
  camera.right = right.cast<float>();
  camera.up = back.cross(right).cast<float>();
  camera.back = back.cast<float>();
  camera.tan_half_height = static_cast<float>(kTanHalfHeight);
  return camera;
}

/// Constraints on the eye e along one axis of the picture. A point p appears at
/// s = (p.axis - e.axis) / ((e.back - p.back) tan), so s <= high and s >= low are linear in e.
/// `most` and `least` are the tightest bounds over all points:
///     e.axis + high tan e.back >= most,    e.axis + low tan e.back <= least
struct Bounds {
  double low, high, most = -1e300, least = 1e300;
  double distance() const { return (most - least) / (high - low); }
  double centred(double d) const { return ((most - high * d) + (least - low * d)) / 2; }
};

Bounds bounds(const std::vector<Vec3>& points, const Vec3& axis, const Vec3& back, double low,
              double high) {
  Bounds b{low, high};
  for (const Vec3& p : points) {
    b.most = std::max(b.most, p.dot(axis) + high * p.dot(back));
    b.least = std::min(b.least, p.dot(axis) + low * p.dot(back));
  }
  return b;
}

struct Fit {
  Camera camera;
  double distance = 0;  ///< m, of the eye along the line of sight, from the origin
};

Fit fit(const std::vector<Vec3>& points, Camera camera, double aspect, const FitRegion& frame) {
  constexpr double tan = kTanHalfHeight;
  const Vec3 right = camera.right.cast<double>(), top = camera.up.cast<double>(),
             back = camera.back.cast<double>();
  const Bounds across =
      bounds(points, right, back, frame.left * tan * aspect, frame.right * tan * aspect);
  const Bounds along = bounds(points, top, back, frame.bottom * tan, frame.top * tan);
  const double distance = std::max(across.distance(), along.distance());
  double nearest = 1e300, farthest = -1e300;
  for (const Vec3& p : points) {
    nearest = std::min(nearest, distance - p.dot(back));
    farthest = std::max(farthest, distance - p.dot(back));
  }
  camera.eye = (right * across.centred(distance) + top * along.centred(distance) + back * distance)
                   .cast<float>();
  camera.near_plane = static_cast<float>(std::max(nearest * 0.3, farthest * 1e-3));
  camera.far_plane = static_cast<float>(farthest * 12);
  return {camera, distance};
}

bool hides_any(const FitRegion& frame, const Camera& camera, float aspect,
               const std::vector<Vec3>& points) {
  const Eigen::Matrix4f clip = camera.world_to_clip(aspect);
  const auto inset_left = static_cast<float>(frame.inset_left);
  const auto inset_bottom = static_cast<float>(frame.inset_bottom);
  return std::ranges::any_of(points, [&](const Vec3& p) {
    const Eigen::Vector4f seen = clip * p.cast<float>().homogeneous();
    return seen.x() > inset_left * seen.w() && seen.y() > inset_bottom * seen.w();
  });
}

}  // namespace

Camera fit_camera(const std::vector<Vec3>& points, const Vec3& up, const View& view, double aspect,
                  const FitRegion& frame) {
  assert(!points.empty());
  const Camera direction = turned(up, view);
  const Fit whole = fit(points, direction, aspect, frame);
  if (!hides_any(frame, whole.camera, static_cast<float>(aspect), points)) return whole.camera;
  FitRegion below = frame, beside = frame;
  below.top = frame.inset_bottom;
  below.right = -frame.left;
  beside.right = frame.inset_left;
  const Fit one = fit(points, direction, aspect, below),
            other = fit(points, direction, aspect, beside);
  return one.distance < other.distance ? one.camera : other.camera;
}

}  // namespace taut
