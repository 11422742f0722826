#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/model/scene.hpp"
#include "core/model/triangle_mesh.hpp"

/// Comparison of a requested scene with the one that an engine holds.
namespace taut {

/// Collects differences, each under the name of the member in which it was found.
class SceneComparison {
 public:
  explicit SceneComparison(double tolerance) : tolerance_(tolerance) {}

  void number(const std::string& what, double a, double b) {
    if (!(std::abs(a - b) <= tolerance_ * std::max(1.0, std::abs(a))))
      found_.push_back(what + ": " + std::to_string(a) + " became " + std::to_string(b));
  }
  void vector(const std::string& what, const Vec3& a, const Vec3& b) {
    for (int axis = 0; axis < 3; ++axis) number(what + "." + "xyz"[axis], a[axis], b[axis]);
  }
  void same(const std::string& what, bool equal) {
    if (!equal) found_.push_back(what + " differs");
  }
  /// Compares sizes, then elements one by one with compare(name, a, b).
  template <class T, class Compare>
  void each(const std::string& what, const std::vector<T>& a, const std::vector<T>& b,
            Compare compare) {
    same(what + ".size", a.size() == b.size());
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
      compare(what + "[" + std::to_string(i) + "]", a[i], b[i]);
  }
  void vectors(const std::string& what, const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    each(what, a, b, [&](const std::string& w, const Vec3& p, const Vec3& q) { vector(w, p, q); });
  }

  void motion(const std::string& what, const Motion& a, const Motion& b) {
    const auto& [velocity, spin, pivot, path] = a;
    vector(what + ".velocity", velocity, b.velocity);
    vector(what + ".spin", spin, b.spin);
    vector(what + ".pivot", pivot, b.pivot);
    each(what + ".path", path, b.path,
         [&](const std::string& w, const Motion::Key& p, const Motion::Key& q) {
           number(w + ".t", p.t, q.t);
           vector(w, p.displacement, q.displacement);
         });
  }

  void shape(const std::string& what, const Shape& a, const Shape& b) {
    same(what + " type", a.index() == b.index());
    if (a.index() != b.index()) return;
    if (const auto* plane = std::get_if<Plane>(&a)) {
      vector(what + ".normal", plane->normal, std::get<Plane>(b).normal);
      number(what + ".offset", plane->offset, std::get<Plane>(b).offset);
    } else if (const auto* ball = std::get_if<Ball>(&a)) {
      vector(what + ".center", ball->center, std::get<Ball>(b).center);
      number(what + ".radius", ball->radius, std::get<Ball>(b).radius);
    } else if (const auto* capsule = std::get_if<Capsule>(&a)) {
      vector(what + ".from", capsule->from, std::get<Capsule>(b).from);
      vector(what + ".to", capsule->to, std::get<Capsule>(b).to);
      number(what + ".radius", capsule->radius, std::get<Capsule>(b).radius);
    } else if (const auto* body = std::get_if<MeshBody>(&a)) {
      const auto& other = std::get<MeshBody>(b);
      vector(what + ".center", body->center, other.center);
      number(what + ".rotation", 1, std::abs(body->rotation.dot(other.rotation)));
      same(what + ".sides", body->sides == other.sides);
      same(what + ".triangles", body->mesh->triangles() == other.mesh->triangles());
      each(what + ".vertices", body->mesh->vertices(), other.mesh->vertices(),
           [&](const std::string& w, const Vec3& p, const Vec3& q) { vector(w, p, q); });
    } else {
      const Box &p = std::get<Box>(a), &q = std::get<Box>(b);
      vector(what + ".center", p.center, q.center);
      vector(what + ".half_extents", p.half_extents, q.half_extents);
      number(what + ".rotation", 1, std::abs(p.rotation.dot(q.rotation)));  // q and -q are equal
    }
  }

  void collider(const std::string& what, const Collider& a, const Collider& b) {
    shape(what, a.shape, b.shape);
    motion(what + ".motion", a.motion, b.motion);
    number(what + ".friction", a.friction, b.friction);
  }

  void link(const std::string& what, const Link& a, const Link& b) {
    same(what + " ends", a.a == b.a && a.b == b.b);
    number(what + ".rest", a.rest, b.rest);
    same(what + ".family", a.family == b.family);
  }

  std::vector<std::string> take() { return std::move(found_); }

 private:
  double tolerance_;
  std::vector<std::string> found_;
};

inline void compare_mesh(SceneComparison& c, const Mesh& asked, const Mesh& held,
                         const std::vector<int>& pins) {
  // "welded" concerns the vertices of a file
  const auto& [rest, triangles, mass, grid, welded] = asked;
  c.vectors("mesh.rest", rest, held.rest);
  c.same("mesh.welded", welded.empty() || held.welded.empty());
  c.same("mesh.triangles", triangles == held.triangles);
  c.same("mesh.mass.size", mass.size() == held.mass.size());
  for (std::size_t i = 0; i < std::min(mass.size(), held.mass.size()); ++i)
    if (!std::binary_search(pins.begin(), pins.end(), static_cast<int>(i)))
      c.number("mesh.mass[" + std::to_string(i) + "] relative", 1, held.mass[i] / mass[i]);
}

inline void compare_wind(SceneComparison& c, const std::optional<Wind>& asked,
                         const std::optional<Wind>& held) {
  c.same("wind", asked.has_value() == held.has_value());
  if (!asked || !held) return;
  const auto& [velocity, strength, law] = *asked;
  c.vector("wind.velocity", velocity, held->velocity);
  c.number("wind.strength", strength, held->strength);
  c.same("wind.law", law == held->law);
}

/// Differences between the simulation that `asked` describes and `held`, a sentence each; empty if
/// they are the same. Numbers agree if they differ by at most `tolerance` relative to the larger of
/// 1 and their size. Not compared, as Bullet does not store them: the labels, the mesh's grid, the
/// masses of pinned vertices, and the stiffness of links, of bending and of the membrane,
/// and the damping of links.
inline std::vector<std::string> differences(const Scene& asked, const Scene& held,
                                            double tolerance) {
  // Names every member, so that a new one does not compile until it is handled.
  const auto& [name, summary, mesh, start, pins, pin_motions, releases, links, stiffness,
               link_damping, bending, membrane, colliders, wind, self_collision, gravity, damping,
               thickness, dt, steps] = asked;
  SceneComparison c(tolerance);
  compare_mesh(c, mesh, held.mesh, pins);
  c.vectors("start.x", start.x, held.start.x);
  // A velocity is the difference of two rounded positions over one step.
  SceneComparison speeds(tolerance * std::max(1.0, extent(asked)) / dt);
  speeds.vectors("start.v", start.v, held.start.v);
  c.same("pins", pins == held.pins);
  c.each("pin_motions", pin_motions, held.pin_motions,
         [&](const std::string& what, const PinMotion& a, const PinMotion& b) {
           c.same(what + ".vertices", a.vertices == b.vertices);
           c.motion(what, a.motion, b.motion);
         });
  // the scene between two releases is a stage of its own
  c.same("releases", releases.empty() && held.releases.empty());
  c.each("links", links, held.links,
         [&](const std::string& what, const Link& a, const Link& b) { c.link(what, a, b); });
  c.each("colliders", colliders, held.colliders,
         [&](const std::string& what, const Collider& a, const Collider& b) {
           c.collider(what, a, b);
         });
  compare_wind(c, wind, held.wind);
  c.same("self_collision", self_collision.has_value() == held.self_collision.has_value());
  if (self_collision && held.self_collision)
    c.number("self_collision.radius", self_collision->radius, held.self_collision->radius);
  c.vector("gravity", gravity, held.gravity);
  c.number("damping", damping, held.damping);
  c.number("thickness", thickness, held.thickness);
  c.number("dt", dt, held.dt);
  c.same("steps", steps == held.steps);
  std::vector<std::string> found = c.take();
  for (std::string& what : speeds.take()) found.push_back(std::move(what));
  return found;
}

}  // namespace taut
