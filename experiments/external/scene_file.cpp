#include "experiments/external/scene_file.hpp"

#include <variant>

#include "experiments/system/json.hpp"

namespace taut::external {

namespace {

Json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json json_of(const std::vector<Vec3>& points) {
  Json all = Json::array();
  for (const Vec3& p : points) all.push_back(json_of(p));
  return all;
}

Json json_of(const Motion& motion) {
  if (motion.at_rest()) return nullptr;
  Json path = Json::array();
  for (const Motion::Key& key : motion.path)
    path.push_back({{"t", key.t}, {"displacement", json_of(key.displacement)}});
  return {{"velocity", json_of(motion.velocity)},
          {"spin", json_of(motion.spin)},
          {"pivot", json_of(motion.pivot)},
          {"path", path}};
}

Json json_of(const Plane& plane) {
  return {{"normal", json_of(plane.normal)}, {"offset", plane.offset}};
}

Json json_of(const Ball& ball) {
  return {{"center", json_of(ball.center)}, {"radius", ball.radius}};
}

Json json_of(const Box& box) {
  const Eigen::Quaterniond& q = box.rotation;
  return {{"center", json_of(box.center)},
          {"half_extents", json_of(box.half_extents)},
          {"rotation", {q.w(), q.x(), q.y(), q.z()}}};
}

Json json_of(const Collider& collider) {
  Json one{{"type", type_name(collider.shape)}};
  one.update(std::visit([](const auto& shape) { return json_of(shape); }, collider.shape));
  one.update({{"friction", collider.friction}, {"motion", json_of(collider.motion)}});
  return one;
}

Json json_of(const Wind& wind) {
  return {{"velocity", json_of(wind.velocity)},
          {"strength", wind.strength},
          {"law", wind.law == Wind::Law::relative ? "relative" : "literal"}};
}

}  // namespace

std::string scene_file(const Scene& scene) {
  Json links = Json::array(), motions = Json::array(), colliders = Json::array();
  for (const Link& link : scene.links)
    links.push_back({link.a, link.b, link.rest, to_string(link.family)});
  for (const PinMotion& group : scene.pin_motions)
    motions.push_back({{"vertices", group.vertices}, {"motion", json_of(group.motion)}});
  for (const Collider& collider : scene.colliders) colliders.push_back(json_of(collider));
  const auto& grid = scene.mesh.grid;
  return to_text(
             {{"format", "taut-scene/1"},
              {"name", scene.name},
              {"vertices", scene.mesh.size()},
              {"grid", grid ? Json{grid->nu, grid->nv} : Json()},
              {"dt", scene.dt},
              {"steps", scene.steps},
              {"gravity", json_of(scene.gravity)},
              {"damping", scene.damping},
              {"thickness", scene.thickness},
              {"x", json_of(scene.start.x)},
              {"v", json_of(scene.start.v)},
              {"rest", json_of(scene.mesh.rest)},
              {"mass", scene.mesh.mass},
              {"inverse_mass", inverse_masses(scene)},
              {"pins", scene.pins},
              {"pin_motions", motions},
              {"links", links},
              {"triangles", scene.mesh.triangles},
              {"colliders", colliders},
              {"wind", scene.wind ? json_of(*scene.wind) : Json()},
              {"self_collision",
               scene.self_collision ? Json{{"radius", scene.self_collision->radius}} : Json()}}) +
         "\n";
}

}  // namespace taut::external
