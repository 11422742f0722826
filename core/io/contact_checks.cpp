#include "core/io/contact_checks.hpp"

#include <algorithm>

#include "core/model/crossings.hpp"
#include "core/model/shortest.hpp"

namespace taut {

namespace {

bool pinned(const Scene& scene, std::size_t i) {
  return std::binary_search(scene.pins.begin(), scene.pins.end(), static_cast<int>(i));
}

/// Moves the free vertices out, collider after collider.
void resolve(Scene& scene) {
  for (const Collider& collider : scene.colliders) {
    const Shape shape = shape_at(collider, 0);
    for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
      const Surface s = surface(shape, scene.start.x[i]);
      if (s.distance < scene.thickness && !pinned(scene, i))
        scene.start.x[i] += (scene.thickness - s.distance) * s.normal;
    }
  }
}

/// A pinned vertex may be inside: that is how a cloth is fixed to an obstacle.
void judge_start(const Value& item, Section& root, const Collider& collider, const Scene& scene) {
  const Shape shape = shape_at(collider, 0);
  const double rounding = 1e-9 * extent(scene);  // of what the file says
  double deepest = 0;
  std::size_t vertex = 0, count = 0;
  for (std::size_t i = 0; i < scene.start.x.size(); ++i) {
    const double depth = -surface(shape, scene.start.x[i]).distance;
    if (pinned(scene, i) || depth <= rounding) continue;
    ++count;
    if (depth > deepest) deepest = depth, vertex = i;
  }
  if (count == 0) return;
  root.diagnostics().report(
      item.place, "the cloth starts inside this " + std::string(type_name(collider.shape)) + ": " +
                      std::to_string(count) + " vertices, vertex " + std::to_string(vertex) + " " +
                      shortest(deepest) +
                      " m deep; move one of them, or set start_inside = \"resolve\" in [cloth]");
}

void judge_path(const Value& item, Section& root, const Collider& collider, const Scene& scene) {
  const auto& path = collider.motion.path;
  const double farthest = extent(scene);  // m, in one time step
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double speed =
        (path[k].displacement - path[k - 1].displacement).norm() / (path[k].t - path[k - 1].t);
    if (speed * scene.dt <= farthest) continue;
    root.diagnostics().report(
        item.place, "the path jumps: from key " + std::to_string(k) + " to key " +
                        std::to_string(k + 1) + " it makes " + shortest(speed * scene.dt) +
                        " m in one time step, more than the size of the cloth");
    return;
  }
}

/// Length of the shortest link between neighbours [m]; 0 if there is none.
double spacing(const Scene& scene) {
  double least = 0;
  for (const Link& link : scene.links)
    if (link.family == Family::structural && (least == 0 || link.rest < least)) least = link.rest;
  return least;
}

void judge_sizes(Section& root, const ContactWishes& wishes, const Scene& scene) {
  const double least = spacing(scene);
  if (least == 0) return;
  if (scene.thickness > least && !scene.colliders.empty())
    root.report("cloth", "thickness " + shortest(scene.thickness) +
                             " m is larger than the spacing " + shortest(least) +
                             " m of the vertices");
  if (!scene.self_collision || wishes.overlap) return;
  if (2 * scene.self_collision->radius > least * (1 + 1e-9))
    root.report("self_collision", "particles of radius " + shortest(scene.self_collision->radius) +
                                      " m overlap at rest, where they are " + shortest(least) +
                                      " m apart: at most half of that, or set overlap = true");
}

}  // namespace

void check_contact(Section& root, const ContactWishes& wishes, Scene& scene) {
  if (wishes.resolve) resolve(scene);
  const auto items = root.tables("collider");
  for (std::size_t k = 0; k < items.size() && k < scene.colliders.size(); ++k) {
    judge_start(*items[k], root, scene.colliders[k], scene);
    judge_path(*items[k], root, scene.colliders[k], scene);
  }
  judge_sizes(root, wishes, scene);
  if (!scene.self_collision) return;
  const auto pairs = crossings(scene.mesh.triangles, scene.start.x);
  if (!pairs.empty())
    root.report("self_collision",
                "the cloth starts through itself: " + std::to_string(pairs.size()) +
                    " pairs of faces cross, the first being " + std::to_string(pairs[0][0]) +
                    " and " + std::to_string(pairs[0][1]));
}

}  // namespace taut
