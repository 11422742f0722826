#include <algorithm>
#include <set>

#include "core/io/scene_readers.hpp"
#include "core/model/angle.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

std::vector<Motion::Key> read_path(Section& section) {
  std::vector<Motion::Key> path;
  for (const Value* item : section.tables("path")) {
    Section key(section.diagnostics(), *item, "'path' in " + section.name());
    key.need({"t", "displacement"});
    const auto t = key.number("t", Range::within(1e6));
    const Vec3 displacement = key.vec3("displacement", kFar, Vec3::Zero());
    key.finish();
    if (!t) continue;
    if (!path.empty() && *t - path.back().t < 1e-9)
      key.report("t", "must grow from key to key: " + shortest(*t) + " follows " +
                          shortest(path.back().t));
    else
      path.push_back({*t, displacement});
  }
  return path;
}

Motion read_motion(Section& section, const Vec3& pivot) {
  Motion motion;
  motion.velocity = section.vec3("velocity", 1e6, Vec3::Zero());
  motion.spin = section.vec3("spin", 1e6, Vec3::Zero());
  motion.pivot = section.vec3("pivot", kFar, pivot);
  motion.path = read_path(section);
  return motion;
}

Collider read_collider(Section& section) {
  Collider collider;
  section.need({"type"});
  const std::string type = section.choice("type", {"plane", "ball", "box"}, "");
  Vec3 pivot = Vec3::Zero();
  if (type == "plane") {
    collider.shape = Plane{section.direction("normal", Vec3::UnitY()),
                           section.number("offset", Range::within(kFar), 0)};
  } else if (type == "ball") {
    section.need({"center", "radius"});
    pivot = section.vec3("center", kFar, Vec3::Zero());
    collider.shape = Ball{pivot, section.number("radius", Range::positive(kFar), 1)};
  } else if (type == "box") {
    section.need({"center", "half_extents"});
    pivot = section.vec3("center", kFar, Vec3::Zero());
    const auto half = section.numbers("half_extents", 3, Range::positive(kFar));
    const Vec3 extents = half ? Vec3((*half)[0], (*half)[1], (*half)[2]) : Vec3::Ones();
    collider.shape = Box{pivot, extents, read_rotation(section)};
  } else {  // reported; which keys belong here is not known
    for (const char* key : {"normal", "offset", "center", "radius", "half_extents", "rotation"})
      section.find(key);
  }
  collider.friction = section.number("friction", Range::non_negative(1e3), 0);
  collider.motion = read_motion(section, pivot);
  section.finish();
  return collider;
}

/// Velocity at t = 0 of the place that starts at x [m/s].
Vec3 initial_velocity(const Motion& motion, const Vec3& x) {
  Vec3 v = motion.velocity + motion.spin.cross(x - motion.pivot);
  const auto& path = motion.path;
  for (std::size_t k = 0; k + 1 < path.size(); ++k)
    if (path[k].t <= 0 && 0 < path[k + 1].t)
      v += (path[k + 1].displacement - path[k].displacement) / (path[k + 1].t - path[k].t);
  return v;
}

}  // namespace

Eigen::Quaterniond read_rotation(Section& section) {
  const Value* value = section.find("rotation");
  if (!value) return Eigen::Quaterniond::Identity();
  if (value->is_array()) {
    const auto q = section.numbers("rotation", 4, Range::within(1e6));
    if (!q) return Eigen::Quaterniond::Identity();
    const Eigen::Quaterniond rotation((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
    if (rotation.norm() > 1e-6) return rotation.normalized();
    section.report("rotation", "must not be zero");
    return Eigen::Quaterniond::Identity();
  }
  if (!value->is_table()) {
    section.report("rotation",
                   "must be { axis, angle } or a quaternion [w, x, y, z], not " + describe(*value));
    return Eigen::Quaterniond::Identity();
  }
  Section rotation(section.diagnostics(), *value, "'rotation' in " + section.name());
  rotation.need({"axis", "angle"});
  const Vec3 axis = rotation.direction("axis", Vec3::UnitY());
  const double angle = rotation.number("angle", Range::within(360), 0);
  rotation.finish();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle * kDegree, axis));
}

void read_colliders(Section& root, Scene& scene) {
  for (const Value* item : root.tables("collider")) {
    Section section(root.diagnostics(), *item, "[[collider]]");
    scene.colliders.push_back(read_collider(section));
  }
}

void read_pin_motions(Section& root, bool built, Scene& scene) {
  std::set<int> moved;
  for (const Value* item : root.tables("pin_motion")) {
    Section section(root.diagnostics(), *item, "[[pin_motion]]");
    PinMotion group;
    section.need({"vertices"});
    if (built) group.vertices = read_vertices(section, "vertices", scene.mesh);
    group.motion = read_motion(section, Vec3::Zero());
    section.finish();
    for (const int vertex : group.vertices) {
      const bool pinned = std::binary_search(scene.pins.begin(), scene.pins.end(), vertex);
      if (!pinned) {
        section.report("vertices", "names vertex " + std::to_string(vertex) + ", which is no pin");
        break;
      }
      if (!moved.insert(vertex).second) {
        section.report("vertices",
                       "names vertex " + std::to_string(vertex) + ", which moves already");
        break;
      }
      const auto v = static_cast<std::size_t>(vertex);
      scene.start.v[v] = initial_velocity(group.motion, scene.start.x[v]);
    }
    if (!group.motion.at_rest()) scene.pin_motions.push_back(std::move(group));
  }
}

}  // namespace taut
