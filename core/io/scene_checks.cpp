// Checks of a scene's file as a whole: whether its parts fit together.
#include <algorithm>
#include <cmath>

#include "core/io/document.hpp"
#include "core/io/scene_readers.hpp"
#include "core/model/body_frames.hpp"
#include "core/model/crossings.hpp"
#include "core/model/index.hpp"
#include "core/model/move_out.hpp"
#include "core/model/text.hpp"

namespace taut {

namespace {

constexpr double kShortestLink = 1e-9;  ///< m
/// Least area of a triangle of a membrane, as a share of its longest side's square.
constexpr double kLeastArea = 1e-9;

bool starts_pinned(const Scene& scene, std::size_t i) {
  return std::binary_search(scene.pins.begin(), scene.pins.end(), static_cast<int>(i));
}

/// Rounding of the file's numbers [m].
double rounding_of(const Scene& scene) { return 1e-9 * extent(scene); }

/// Moves free vertices to the thickness above all colliders: those that are above their surfaces
/// but closer, or `all`. A step would turn that way into velocity.
void resolve(Scene& scene, bool all) {
  std::vector<Shape> shapes;
  for (const Collider& collider : scene.colliders) shapes.push_back(shape_at(collider, 0));
  const double rounding = rounding_of(scene);
  for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
    if (starts_pinned(scene, i)) continue;
    double nearest = scene.thickness;
    for (const Shape& shape : shapes)
      nearest = std::min(nearest, surface(shape, scene.start.x[i]).distance);
    if (all || (nearest >= -rounding && nearest < scene.thickness - rounding))
      scene.start.x[i] = moved_out(shapes, scene.start.x[i], scene.thickness);
  }
}

/// Reports free vertices inside a collider. A pinned vertex may be inside: that is how a cloth is
/// fixed to an obstacle.
void judge_start(const Value& item, Section& root, const FileKeys& said, const Collider& collider,
                 const Scene& scene) {
  const Shape shape = shape_at(collider, 0);
  const double rounding = rounding_of(scene);
  double deepest = 0;
  std::size_t vertex = 0, count = 0;
  for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
    const double depth = -surface(shape, scene.start.x[i]).distance;
    if (starts_pinned(scene, i) || depth <= rounding) continue;
    ++count;
    if (depth > deepest) {
      deepest = depth;
      vertex = i;
    }
  }
  if (count == 0) return;
  root.diagnostics().report(
      item.place, "the cloth starts inside this " + std::string(type_name(collider.shape)) + ": " +
                      std::to_string(count) + " vertices, vertex " + std::to_string(vertex) + " " +
                      as_typed(std::round(1e9 * deepest) / 1e9) + " m deep; " +
                      (said.start_inside == FileKeys::Inside::resolve
                           ? "start_inside = \"resolve\" found no way out: move one of them"
                           : "move one of them, or set start_inside = \"resolve\" in [cloth]") +
                      root.diagnostics().remarks_at(item.place));
}

/// Reports a thin body without thickness: the side of the cloth is only known while the cloth keeps
/// off the body.
void judge_thin(const Value& item, Section& root, const Collider& collider, const Scene& scene) {
  const MeshBody* body = std::get_if<MeshBody>(&collider.shape);
  if (!body || body->sides != MeshBody::Sides::both || scene.thickness > 0) return;
  root.diagnostics().report(item.place,
                            "a body with sides = \"both\" is thin: it keeps the cloth out only at "
                            "a 'thickness' in [cloth] above 0");
}

/// Reports a path that jumps. A motion that lasts a time step or longer is fast, not a jump.
void judge_path(const Value& item, Section& root, const Collider& collider, const Scene& scene) {
  const auto& path = collider.motion.path;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double way = (path[k].displacement - path[k - 1].displacement).norm();
    if (path[k].t - path[k - 1].t >= scene.dt || way <= extent(scene)) continue;
    root.diagnostics().report(item.place,
                              "the path jumps: from key " + std::to_string(k) + " to key " +
                                  std::to_string(k + 1) + " it makes " + as_typed(way) +
                                  " m within one time step, more than the size of the cloth");
    return;
  }
}

/// Reports a body that moves farther than its own size within a time step: it is then somewhere
/// else, and has not moved there.
void judge_frames(const Value& item, Section& root, const Collider& collider, const Scene& scene) {
  if (!collider.frames) return;
  const auto& places = collider.frames->places;
  const double size = std::get<MeshBody>(collider.shape).mesh->box().diagonal().norm();
  const double in_a_step = std::min(1.0, scene.dt * collider.frames->fps);
  for (std::size_t k = 1; k < places.size(); ++k)
    for (std::size_t i = 0; i < places[k].size(); ++i) {
      const double way = in_a_step * (places[k][i] - places[k - 1][i]).norm();
      if (way <= size) continue;
      root.diagnostics().report(item.find("frames")->place,
                                "'frames' in [[collider]]: the body jumps: from frame " +
                                    std::to_string(k - 1) + " to frame " + std::to_string(k) +
                                    " vertex " + std::to_string(i) + " makes " + as_typed(way) +
                                    " m within one time step, more than the size of the body");
      return;
    }
}

/// Length of the shortest structural link, seams excluded, or side of a membrane's triangle [m]; 0
/// if there is neither.
double spacing(const Scene& scene) {
  double least = 0;
  const auto add = [&](int a, int b) {
    const double side = (scene.mesh.rest[to_index(b)] - scene.mesh.rest[to_index(a)]).norm();
    if (least == 0 || side < least) least = side;
  };
  if (scene.membrane)
    for (const auto& [a, b, c] : scene.mesh.triangles) {
      add(a, b);
      add(b, c);
      add(a, c);
    }
  for (const Link& link : scene.links)
    if (link.family == Family::structural && !is_seam(link) && (least == 0 || link.rest < least))
      least = link.rest;
  return least;
}

void judge_sizes(Section& root, const FileKeys& said, const Scene& scene) {
  const double least = spacing(scene);
  if (least == 0) return;
  if (scene.thickness > least && !scene.colliders.empty())
    root.report("cloth", "thickness " + as_typed(scene.thickness) +
                             " m is larger than the spacing " + as_typed(least) +
                             " m of the vertices");
  if (!scene.self_collision || said.overlap) return;
  if (2 * scene.self_collision->radius > least * (1 + 1e-9))
    root.report("self_collision", "particles of radius " + as_typed(scene.self_collision->radius) +
                                      " m overlap at rest, where they are " + as_typed(least) +
                                      " m apart: at most half of that, or set overlap = true");
}

/// Reports a membrane whose triangles cannot have a strain.
void judge_membrane(Section& root, const Scene& scene) {
  Diagnostics& diagnostics = root.diagnostics();
  const auto report = [&](const std::string& what) {
    diagnostics.report(root.place("membrane"), what);
  };
  if (scene.mesh.triangles.empty()) report("[membrane] acts on faces, and this cloth has none");
  if (scene.membrane->direction.isZero(0))
    report(
        "'warp' in [membrane] is missing: a mesh needs the direction of its warp where that "
        "matters");
  const auto flat = [](const std::vector<Vec3>& x, const Triangle& t) {
    const Vec3 &a = x[to_index(t[0])], &b = x[to_index(t[1])], &c = x[to_index(t[2])];
    const double longest =
        std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    return !((b - a).cross(c - a).norm() > kLeastArea * longest);
  };
  for (const Triangle& t : scene.mesh.triangles) {
    const bool at_rest = flat(scene.mesh.rest, t);
    if (!at_rest && !flat(scene.start.x, t)) continue;
    const std::string who = "the face of vertices " + std::to_string(t[0]) + ", " +
                            std::to_string(t[1]) + " and " + std::to_string(t[2]);
    return report(who + (at_rest ? " has no area: [membrane] has no strain there"
                                 : " starts on a line: [membrane] has no direction there in which "
                                   "to open it; move a vertex of it off the line"));
  }
}

}  // namespace

void check_whole(Section& root, const Scene& scene) {
  Diagnostics& diagnostics = root.diagnostics();
  for (const Link& link : scene.links)
    if (!is_seam(link) && !(link.rest >= kShortestLink)) {
      diagnostics.report(root.place("cloth"), "vertices " + std::to_string(link.a) + " and " +
                                                  std::to_string(link.b) +
                                                  " coincide: their link has no length");
      break;
    }
  if (scene.bending && scene.mesh.triangles.empty())
    diagnostics.report(root.place("bending"), "[bending] acts on faces, and this cloth has none");
  if (scene.bending && scene.bending->direction.isZero(0))
    diagnostics.report(root.place("bending"),
                       "'warp' in [bending] is missing: where warp and weft differ, a mesh needs "
                       "the direction of its warp");
  if (scene.membrane) judge_membrane(root, scene);
  if (scene.link_damping > 0 && elastic_links(scene).empty())
    diagnostics.report(root.table("links")->find("damping")->place,
                       "'damping' in [links] is in proportion to the stiffness of links, and these "
                       "are rigid: give them one in [links] stiffness, or take 'damping' in "
                       "[forces], which brakes a fall, too");
  if (scene.wind && scene.mesh.triangles.empty())
    diagnostics.report(root.place("wind"), "[wind] acts on faces, and this cloth has none");
}

void check_contact(Section& root, const FileKeys& said, Scene& scene) {
  resolve(scene, said.start_inside == FileKeys::Inside::resolve);
  const auto items = root.tables("collider");
  for (std::size_t k = 0; k < items.size() && k < scene.colliders.size(); ++k) {
    judge_start(*items[k], root, said, scene.colliders[k], scene);
    judge_path(*items[k], root, scene.colliders[k], scene);
    judge_frames(*items[k], root, scene.colliders[k], scene);
    judge_thin(*items[k], root, scene.colliders[k], scene);
  }
  judge_sizes(root, said, scene);
  if (!scene.self_collision) return;
  const auto pairs = crossings(scene.mesh.triangles, scene.start.x);
  if (!pairs.empty())
    root.report("self_collision",
                "the cloth starts through itself: " + std::to_string(pairs.size()) +
                    " pairs of faces cross, the first being " + std::to_string(pairs[0][0]) +
                    " and " + std::to_string(pairs[0][1]));
}

}  // namespace taut
